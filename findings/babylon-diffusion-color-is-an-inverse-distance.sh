#!/usr/bin/env bash
# The color of a diffusion profile of Babylon.js is an inverse distance: a brighter channel spreads less.
#
# Version: @babylonjs/core 9.35.0 (npm), Node 20, g++.
# Expected: that a channel of a greater color spreads farther, as in Unity's HDRP, whose method it is: there the color is
#           the scattering distance and S = 1/distance. addDiffusionProfile says "should be the average color of the
#           material", and its own comment "rcp(s) = ScatteringDistance".
# Seen: ssDiffusionS has the color as it is, and the shader draws exp(-S r) with it: from 1 to 2 mm a channel of 1 falls by
#       a factor of 1.7 (r R, as the shader counts), one of 0.1 by 1.1. The radii are drawn with the greatest channel as the distance, so that
#       they are right for a color of 1 alone.
# Fails if that changes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
npm init --yes > /dev/null
npm install --silent --no-fund --no-audit @babylonjs/core@9.35.0

cat > profile.mjs <<'JS'
import { readFileSync, writeFileSync } from 'node:fs';
import { Color3 } from '@babylonjs/core/Maths/math.color.js';
import { SubSurfaceConfiguration } from '@babylonjs/core/Rendering/subSurfaceConfiguration.js';

const configuration = new SubSurfaceConfiguration( { _getComponent: () => true } );
const index = configuration.addDiffusionProfile( new Color3( 1, 0.5, 0.1 ) );
const channels = configuration.ssDiffusionS.slice( 3 * index, 3 * index + 3 );
console.log( `S = ${ channels.join( ', ' ) }, distance of the radii = ${ configuration.ssDiffusionD[ index ] }` );

// The shader's own function, with as much of GLSL as it needs
const shader = readFileSync( 'node_modules/@babylonjs/core/Shaders/subSurfaceScattering.fragment.js', 'utf8' );
const body = shader.match( /vec3 EvalBurleyDiffusionProfile\([^]*?return[^]*?\}/ )[ 0 ];
writeFileSync( 'profile.cpp', `#include <cmath>
#include <cstdio>
struct vec3 { float x, y, z; };
vec3 operator*( vec3 a, vec3 b ) { return { a.x * b.x, a.y * b.y, a.z * b.z }; }
vec3 operator*( vec3 a, float b ) { return { a.x * b, a.y * b, a.z * b }; }
vec3 operator*( float a, vec3 b ) { return b * a; }
vec3 operator/( vec3 a, float b ) { return a * ( 1.0f / b ); }
vec3 operator+( float a, vec3 b ) { return { a + b.x, a + b.y, a + b.z }; }
vec3 exp2( vec3 a ) { return { std::exp2( a.x ), std::exp2( a.y ), std::exp2( a.z ) }; }
const float PI = 3.14159265f, LOG2_E = 1.44269504f;
#define rcp(x) 1.f / x
${ body }
int main() {
	vec3 s = { ${ channels.join( ', ' ) } };
	vec3 a = EvalBurleyDiffusionProfile( 1, s ), b = EvalBurleyDiffusionProfile( 2, s );
	std::printf( "falls by %.1f, %.1f, %.1f\\n", a.x / b.x, a.y / b.y, a.z / b.z );
}
` );
JS
node profile.mjs | tee seen.txt
g++ -O1 -w profile.cpp -o profile
./profile | tee -a seen.txt
diff seen.txt - <<'SEEN'
S = 1, 0.5, 0.1, distance of the radii = 1
falls by 1.7, 1.3, 1.1
SEEN
