#version 330
// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
in vec2 corner;
uniform mat3 ray_of_clip;       // clip coordinates -> ray in world axes, depth 1
out vec3 ray;

void main()
{
    gl_Position = vec4(corner, 0.0, 1.0);
    ray = ray_of_clip * vec3(corner, 1.0);
}
