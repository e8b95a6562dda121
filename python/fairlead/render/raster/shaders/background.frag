#version 330
// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
// Sky and sea without geometry: each ray meets the curved sea, whose waves are textures of slopes. Slopes that are too
// fine to be seen become variance, so that nothing flickers. docs/rendering.md section 4.

in vec3 ray;
out vec4 colour;

uniform float height;           // of the camera above the sea
uniform vec2 under[4];          // the camera's nadir in each tile, share of its side
uniform mat2 into_tile[4];      // world axes -> share of the tile's side
uniform sampler2D waves[4];     // slope x, slope y, half their squares' sum, squeeze
uniform float breaking;
uniform float fine_variance;    // of slopes finer than the tiles
uniform vec2 eye_xy;            // of the camera, for the noise [m]
uniform sampler2D wake_near, wake_far;
uniform vec4 near_box, far_box; // x0, y0, 1 / width, 1 / height
uniform mat3x2 hull_of_eye;   // offset from the nadir -> axes of the wake
uniform vec3 water;             // what comes up from below, per irradiance
uniform mat4 box_of_eye;      // target's box: -1..1
uniform vec3 box_colour;
uniform mat4 shadow_of_eye;
uniform sampler2DShadow shadow_map;
uniform vec4 earth;             // direction, cosine of its radius
uniform float gusts;

float turbulence(vec2 p) { return texture(noise_map, p).r; }

vec3 wake_at(vec2 p)
{
    vec2 h = hull_of_eye * vec3(p, 1.0);
    vec2 far_place = abs((h - far_box.xy) * far_box.zw - 0.5);
    if (max(far_place.x, far_place.y) > 0.5) return vec3(0.0);
    vec3 far_part = texture(wake_far, (h - far_box.xy) * far_box.zw).rgb;
    vec2 near_place = (h - near_box.xy) * near_box.zw;
    vec3 near_part = texture(wake_near, near_place).rgb;
    vec2 inside = smoothstep(vec2(0.0), vec2(0.06), near_place) * smoothstep(vec2(0.0), vec2(0.06), 1.0 - near_place);
    return mix(far_part, near_part, inside.x * inside.y);
}

// How much of a reflected ray ends on the target: its box, softened by the waves.
float on_target(vec3 from, vec3 d, float spread)
{
    vec3 o = (box_of_eye * vec4(from, 1.0)).xyz;
    vec3 r = (box_of_eye * vec4(d, 0.0)).xyz;
    vec3 a = (-1.0 - o) / r, b = (1.0 - o) / r;
    vec3 first = min(a, b), last = max(a, b);
    float enter = max(max(first.x, first.y), max(first.z, 0.0)), leave = min(last.x, min(last.y, last.z));
    float depth = (leave - enter) * length(r);
    return smoothstep(0.0, 0.15 + 2.0 * spread, depth) * exp(-enter * (0.004 + 0.03 * spread));
}

// The level of detail of a footprint that is much longer than wide: between both, so that far waves keep their crests.
vec4 wave(sampler2D map, vec2 at)
{
    vec2 texels = vec2(textureSize(map, 0));
    float a = length(dFdx(at) * texels), b = length(dFdy(at) * texels);
    return textureLod(map, at, max(0.0, 0.35 * log2(max(a, b)) + 0.65 * log2(max(min(a, b), 1e-6))));
}

void add_waves(vec4 w, inout vec2 slope, inout float variance, inout float squeeze)
{
    slope += w.xy;
    variance += max(w.z - 0.5 * dot(w.xy, w.xy), 0.0);
    squeeze += w.w;
}

vec4 sea(vec3 d, float t)
{
    vec2 p = t * d.xy;
    vec2 world = p + eye_xy;
    vec3 wake = wake_at(p);
    float gust = mix(1.0, 0.55 + 0.9 * turbulence(world / 1900.0), gusts);
    vec2 slope = vec2(0.0);
    float variance = fine_variance, squeeze = 0.0;
    add_waves(wave(waves[0], under[0] + into_tile[0] * p), slope, variance, squeeze);
    add_waves(wave(waves[1], under[1] + into_tile[1] * p), slope, variance, squeeze);
    add_waves(wave(waves[2], under[2] + into_tile[2] * p), slope, variance, squeeze);
    add_waves(wave(waves[3], under[3] + into_tile[3] * p), slope, variance, squeeze);
    float calm = 1.0 - 0.55 * clamp(wake.x, 0.0, 1.0);
    slope = slope * sqrt(gust) * calm + wake.yz;
    variance *= gust * calm;
    vec3 v = -d;
    float spread = sqrt(variance);
    slope -= variance * v.xy / max(v.z, 1.5 * spread);
    vec3 n = normalize(vec3(-slope, 1.0));
    float facing = clamp(dot(n, v), 0.02, 1.0);
    float fresnel = 0.02 + 0.98 * pow(1.0 - facing, 5.0 * exp(-2.69 * spread)) / (1.0 + 22.7 * pow(spread, 1.5));
    vec3 r = reflect(d, n);
    r = normalize(vec3(r.xy, max(abs(r.z), 0.02)));
    vec3 mirrored = sky_at(r, log2(1.0 + 163.0 * spread));
    vec4 in_shadow = shadow_of_eye * vec4(p, -height, 1.0);
    float lit = any(greaterThan(abs(in_shadow.xy - 0.5), vec2(0.499))) ? 1.0 : texture(shadow_map, in_shadow.xyz);
    mirrored = mix(mirrored, box_colour, on_target(vec3(p, -height), r, spread));

    vec3 h = normalize(sun + v + vec3(0.0, 0.0, 1e-4));
    vec2 wanted = -h.xy / max(h.z, 0.05) - slope;
    float s2 = variance + 0.0012;
    float chance = exp(-0.5 * dot(wanted, wanted) / s2) / (2.0 * PI * s2);
    float sparkle = 0.02 + 0.98 * pow(1.0 - clamp(dot(h, v), 0.0, 1.0), 5.0);
    vec3 glint = sun_irradiance * min(sparkle * chance / (4.0 * pow(max(h.z, 0.05), 4.0) * max(facing, 0.06)), 40.0);
    if (sun.z <= 0.0) glint = vec3(0.0);

    vec3 light = irradiance(vec3(0.0, 0.0, 1.0)) + lit * sun_irradiance * max(sun.z, 0.0);
    vec3 radiance = mix(water * light, mirrored, fresnel) + lit * glint;

    float foam = 0.0;
    if (wake.x > 0.01 || squeeze > 0.6 * breaking) {
        float bubbles = 0.4 * turbulence(world / 61.0) + 0.35 * turbulence(world / 17.0) + 0.25 * turbulence(world / 4.3);
        float cap = smoothstep(breaking, 1.5 * breaking, squeeze * sqrt(gust)) * smoothstep(0.35, 0.6, bubbles);
        float level = 1.0 - wake.x;
        float trail = smoothstep(level - 0.30, level + 0.22, 0.5 + 1.9 * (bubbles - 0.5)) * smoothstep(0.02, 0.12, wake.x);
        foam = clamp(max(0.85 * cap, trail), 0.0, 1.0);
    }
    vec3 churned = mix(water, vec3(0.05, 0.11, 0.12), 0.55) * light * clamp(wake.x, 0.0, 1.0) * 0.8;
    radiance = mix(radiance + churned * (1.0 - fresnel), vec3(0.56, 0.60, 0.62) * light / PI, foam);
    return vec4(through_air(radiance, t), min(t, FAR));
}

// In a room sky_map holds all directions, rows even in the angle from straight up.
vec3 backdrop(vec3 d)
{
    return textureLod(sky_map, vec2(atan(d.y, d.x) / (2.0 * PI), acos(clamp(d.z, -1.0, 1.0)) / PI), 0.0).rgb;
}

vec3 outer_space(vec3 d)
{
    vec3 cell = floor(d * 260.0);
    float star = fract(sin(dot(cell, vec3(12.9898, 78.233, 37.719))) * 43758.5453);
    vec3 radiance = vec3(smoothstep(0.9985, 1.0, star) * 0.25 * (1.0 - smoothstep(0.2, 0.5, length(fract(d * 260.0) - 0.5))));
    float c = dot(d, earth.xyz);
    if (c > earth.w) {
        float off = sqrt(max((1.0 - c * c) / (1.0 - earth.w * earth.w), 0.0));
        vec3 tangent = (d - c * earth.xyz) / max(length(d - c * earth.xyz), 1e-6);
        vec3 n = normalize(off * tangent - sqrt(max(1.0 - off * off, 0.0)) * earth.xyz);
        float cloud = smoothstep(0.45, 0.75, 0.7 * turbulence(n.xy * 0.9 + n.z) + 0.3 * turbulence(n.yz * 3.1));
        vec3 ground = mix(vec3(0.02, 0.06, 0.16), vec3(0.20, 0.17, 0.10), smoothstep(0.5, 0.6, turbulence(n.zx * 0.5)));
        float day = max(dot(n, sun), 0.0);
        radiance = mix(ground, vec3(0.75), cloud) * day * sun_irradiance / PI;
        radiance += vec3(0.10, 0.22, 0.5) * pow(clamp(off, 0.0, 1.0), 6.0) * day;
    }
    return radiance;
}

void main()
{
    vec3 d = normalize(ray);
    if (place == 1) { colour = vec4(outer_space(d), FAR); return; }
    if (place == 2) { colour = vec4(backdrop(d), FAR); return; }
    float curve = (1.0 - d.z * d.z) / (2.0 * 7.3e6);
    float inside = d.z * d.z - 4.0 * curve * height;
    bool hits = d.z < 0.0 && inside > 0.0;
    float t = hits ? 2.0 * height / (-d.z + sqrt(max(inside, 0.0))) : FAR;
    vec4 s = sea(vec3(d.xy, min(d.z, -1e-4)), min(t, FAR));
    vec3 above = sky_at(d, 0.0);
    above += sun_irradiance * 900.0 * smoothstep(0.99998, 0.999992, dot(d, sun));
    colour = hits ? s : vec4(min(above, vec3(200.0)), FAR);
}
