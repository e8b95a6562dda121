// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
// What both programs know of the light: sky, sun, air. World axes, z up, lengths in metres.

const float PI = 3.14159265;
const float FAR = 60000.0;

uniform sampler2D sky_map;      // column: azimuth; row: square root of the elevation
uniform sampler2D noise_map;    // fractal, repeats
uniform vec3 sun;               // unit, towards it
uniform vec3 sun_irradiance;
uniform vec3 shade[9];          // irradiance of everything else, spherical harmonics
uniform float air;              // what clear air takes of the light [1/m]
uniform int place;              // 0 sea, 1 space, 2 room
uniform vec3 haze_left, haze_right; // radiance of the horizon at both edges of the image
uniform float width;                // of the image [px]

vec3 sky_at(vec3 d, float lod)
{
    if (place == 1) return vec3(0.0);
    float elevation = asin(clamp(d.z, 0.0, 1.0));
    return textureLod(sky_map, vec2(atan(d.y, d.x) / (2.0 * PI), sqrt(elevation / (0.5 * PI))), lod).rgb;
}

vec3 irradiance(vec3 n)
{
    vec3 e = 0.282095 * shade[0] + 0.488603 * (n.y * shade[1] + n.z * shade[2] + n.x * shade[3]);
    e += 1.092548 * (n.x * n.y * shade[4] + n.y * n.z * shade[5] + n.x * n.z * shade[7]);
    e += 0.315392 * (3.0 * n.z * n.z - 1.0) * shade[6] + 0.546274 * (n.x * n.x - n.y * n.y) * shade[8];
    return max(e, vec3(0.0));
}

vec3 through_air(vec3 radiance, float distance)
{
    if (place != 0) return radiance;
    vec3 horizon = mix(haze_left, haze_right, gl_FragCoord.x / width);
    return mix(horizon, radiance, exp(-air * distance));
}
