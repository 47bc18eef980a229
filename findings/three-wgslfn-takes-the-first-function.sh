#!/usr/bin/env bash
# The parser behind wgslFn of three.js makes a node of the first function of a WGSL text, whatever follows.
#
# Version: three 0.187.0 (npm), Node 20.
# Expected: of a text with a helper and then the function that uses it, either the last one, or an error that asks which;
#           WGSL lets functions come in any order, and formulas for shaders mostly begin with their helpers.
# Seen: name, inputs and type of the helper, without a message; the rest becomes the helper's "block". Comments before it
#       are skipped, but a text that begins with a constant is no function at all. wgsl() takes a text whole, and a wgslFn
#       that includes it may call any function in it.
# Fails if that changes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
npm init --yes > /dev/null
npm install --silent --no-fund --no-audit three@0.187.0

cat > parse.mjs <<'JS'
import { readFileSync } from 'node:fs';
import WGSLNodeFunction from 'three/src/renderers/webgpu/nodes/WGSLNodeFunction.js';

const helper = 'fn half_of( x: f32 ) -> f32 { return 0.5 * x; }';
const main = 'fn falloff( r: f32, d: vec3<f32> ) -> vec3<f32> { return exp( - half_of( r ) / d ); }';
const seen = ( text ) => {
	try {
		const { name, type, inputs } = new WGSLNodeFunction( text );
		return `${ name }(${ inputs.map( ( input ) => `${ input.name }: ${ input.type }` ).join( ', ' ) }) -> ${ type }`;
	} catch ( error ) {
		return 'refused';
	}
};
console.log( seen( `// A falloff.\n${ helper }\n${ main }` ) );
console.log( seen( `// A falloff.\n${ main }\n${ helper }` ) );
console.log( seen( `const HALF: f32 = 0.5;\n${ main }\n${ helper }` ) );
JS
node parse.mjs | tee seen.txt
diff seen.txt - <<'SEEN'
half_of(x: float) -> float
falloff(r: float, d: vec3) -> vec3
refused
SEEN
