#version 330
// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
in vec3 position;
uniform mat4 light_of_target;

void main() { gl_Position = light_of_target * vec4(position, 1.0); }
