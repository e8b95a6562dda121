#version 330
// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
// Painted surfaces: diffuse, a rough highlight, a reflection of the sky, weather on the paint.

centroid in vec3 at, n;
centroid in vec4 material;
centroid in float ambient;
centroid in vec3 local;
out vec4 colour;

uniform mat4 shadow_of_eye;
uniform sampler2DShadow shadow_map;
uniform int shadowed;
uniform float weathering;
uniform float inverse_size;

float lit_share()
{
    if (shadowed == 0) return 1.0;
    vec3 p = (shadow_of_eye * vec4(at, 1.0)).xyz;
    float step = 0.7 / float(textureSize(shadow_map, 0).x);
    return 0.5 * (texture(shadow_map, p + vec3(-step, step, -0.0015)) + texture(shadow_map, p + vec3(step, -step, -0.0015)));
}

void main()
{
    vec3 v = normalize(-at);
    vec3 normal = normalize(n);
    if (dot(normal, v) < 0.0) normal = -normal;
    vec3 base = max(material.rgb, vec3(0.0));
    vec2 place = vec2(local.x + 0.7 * local.y, 0.22 * local.z + 0.05 * local.x) * inverse_size;
    float stain = texture(noise_map, 2.0 * place).r, patches = 1.0 - stain;
    base *= mix(1.0, 0.55 + 0.9 * patches, 0.45 * weathering);
    base = mix(base, vec3(0.16, 0.085, 0.045), weathering * 0.6 * smoothstep(0.66, 0.9, stain) * (1.0 - normal.z));
    float rough = material.a;
    float towards = max(dot(normal, sun), 0.0) * lit_share();
    vec3 radiance = base / PI * (irradiance(normal) * ambient + sun_irradiance * towards);
    vec3 h = normalize(sun + v + 1e-4 * normal);
    float a = max(rough * rough, 0.01), nh = clamp(dot(normal, h), 0.0, 1.0);
    float q = nh * nh * (a * a - 1.0) + 1.0;
    float fresnel = 0.04 + 0.96 * pow(1.0 - clamp(dot(h, v), 0.0, 1.0), 5.0);
    radiance += sun_irradiance * towards * min(fresnel * a * a / (PI * q * q) * 0.25 / max(dot(normal, v), 0.1), 12.0);
    vec3 r = reflect(-v, normal);
    float mirror = 0.04 + (1.0 - rough) * 0.96 * pow(1.0 - clamp(dot(normal, v), 0.0, 1.0), 5.0);
    vec3 seen = irradiance(r) / PI;
    radiance += mirror * (1.0 - 0.6 * rough) * ambient * seen;
    float distance = length(at);
    colour = vec4(max(through_air(radiance, distance), vec3(0.0)), min(distance, FAR));
}
