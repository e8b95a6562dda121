#version 330
// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
// Depth and number of what is seen at the pixel's centre.
in float z;
out vec4 colour;
uniform float number;

void main() { colour = vec4(z, number, 0.0, 1.0); }
