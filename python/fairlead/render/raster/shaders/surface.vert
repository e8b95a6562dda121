#version 330
// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
in vec3 position, normal;
in vec4 paint;                  // linear colour, roughness
in float open_sky;              // share of the surroundings that is not hidden by the surface itself
uniform mat4 clip_of_target;
uniform mat4 eye_of_target;   // world axes, origin at the camera
uniform vec3 in_camera;         // row of T_camera_target that gives the depth
uniform float in_camera_z;
uniform float waterline;        // z of the sea in axes of eye_of_target
// centroid: a sample at an edge must not be shaded from outside its triangle
centroid out vec3 at, n;
centroid out vec4 material;
centroid out float ambient;
centroid out vec3 local;
out float z;

void main()
{
    gl_Position = clip_of_target * vec4(position, 1.0);
    at = (eye_of_target * vec4(position, 1.0)).xyz;
    n = mat3(eye_of_target) * normal;
    material = paint;
    ambient = open_sky;
    local = position;
    z = dot(in_camera, position) + in_camera_z;
    gl_ClipDistance[0] = at.z - waterline;
}
