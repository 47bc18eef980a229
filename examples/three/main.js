// Subsurface scattering in screen space: translucid writes the disk of taps as GLSL, a ShaderMaterial of three.js gathers light.

import * as THREE from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { PLYLoader } from "three/addons/loaders/PLYLoader.js";
import init, { Profile, exportText, preset } from "translucid";

const MODEL = "normalized-diffusion-refined";
const PRESETS = ["skin1", "jade", "wax", "marble", "alabaster", "grape", "butter", "ketchup"];
const COLORS = ["#ff5a4d", "#4fd66b", "#5b8cff"];
const HEIGHT = 80; // of the bust in millimeters; lengths are millimeters in the scene, too
const TAPS = 25;

const byId = (id) => document.getElementById(id);

/** Three sliders, for red, green and blue. */
function sliders(id, attributes, { numberOf = Number, positionOf = Number } = {}) {
    const inputs = COLORS.map((color, i) => {
        const [label, output] = [document.createElement("label"), document.createElement("output")];
        const input = Object.assign(document.createElement("input"), { type: "range", step: 0.001, ...attributes });
        input.ariaLabel = `${id} ${["red", "green", "blue"][i]}`;
        input.style.setProperty("--color", color);
        input.oninput = changed;
        label.append(input, output);
        byId(id).append(label);
        return { input, output };
    });
    return {
        get numbers() {
            return inputs.map(({ input, output }) => {
                const number = numberOf(input.value);
                output.textContent = number.toFixed(2);
                return number;
            });
        },
        set numbers(numbers) {
            inputs.forEach(({ input }, i) => (input.value = positionOf(numbers[i])));
        },
    };
}
const albedo = sliders("albedo", { min: 0.01, max: 0.99 });
const mfp = sliders("mfp", { min: -1, max: 1 }, { numberOf: (x) => 10 ** x, positionOf: Math.log10 }); // 0.1 to 10 mm
byId("preset").onchange = () => {
    const { surfaceAlbedo, mfp: lengths } = preset(byId("preset").value);
    [albedo.numbers, mfp.numbers] = [surfaceAlbedo, lengths];
    changed();
};
byId("scattering").onchange = changed;

// A scene as usual, whose surfaces are white: the picture of it is the irradiance over π
const renderer = new THREE.WebGLRenderer();
// Four pixels for each that is shown, which smooths edges and noise; `?ratio=1` is faster
renderer.setPixelRatio(Number(new URLSearchParams(location.search).get("ratio") ?? 2));
renderer.shadowMap.enabled = true;
renderer.toneMapping = THREE.AgXToneMapping;
renderer.toneMappingExposure = 1.3;
byId("view").append(renderer.domElement);
const camera = new THREE.PerspectiveCamera(26, 1, 20, 800);
camera.position.set(-50, 14, 205);
const controls = new OrbitControls(camera, renderer.domElement);
controls.addEventListener("change", () => draw());

const scene = new THREE.Scene();
const white = new THREE.MeshLambertMaterial();
const normals = new THREE.MeshNormalMaterial();
const key = new THREE.DirectionalLight(0xfff0dd, 6.5);
key.position.set(90, 75, 55);
key.castShadow = true;
key.shadow.mapSize.set(2048, 2048);
key.shadow.normalBias = 0.4;
Object.assign(key.shadow.camera, { left: -60, right: 60, top: 60, bottom: -60, near: 10, far: 250 });
const rim = new THREE.DirectionalLight(0xa8c4ff, 2.2);
rim.position.set(-80, 30, -60);
scene.add(key, rim, new THREE.HemisphereLight(0xbfd2ff, 0x2a2018, 0.35));

const target = (options) =>
    new THREE.WebGLRenderTarget(1, 1, { type: THREE.HalfFloatType, magFilter: THREE.NearestFilter, ...options });
const [irradiance, normal] = [target({ depthTexture: new THREE.DepthTexture(1, 1, THREE.FloatType) }), target()];

// The pass; before it stands what `exportText` writes
const PASS = `
uniform sampler2D irradiance, depth, normal;
uniform mat4 projection, viewFromClip;
uniform vec3 toLight;
uniform bool scattering;
in vec2 at;

vec3 positionAt(vec2 uv) {
    vec4 position = viewFromClip * vec4(2.0 * vec3(uv, texture(depth, uv).r) - 1.0, 1.0);
    return position.xyz / position.w;
}

// Interleaved gradient noise by J. Jimenez (Next Generation Post Processing in Call of Duty, SIGGRAPH 2014)
float noise(vec2 pixel) { return fract(52.9829189 * fract(dot(pixel, vec2(0.06711056, 0.00583715)))); }

vec3 scattered(vec4 here) {
    vec3 center = positionAt(at), n = normalize(2.0 * texture(normal, at).xyz - 1.0);
    vec3 t = normalize(cross(abs(n.x) > 0.7 ? vec3(0, 1, 0) : vec3(1, 0, 0), n)), b = cross(n, t);
    vec3 light = vec3(0), seen = vec3(1e-6);
    for (int i = 0; i < 2 * ${TAPS}; i++) { // each tap twice, the second time turned by half a turn
        float angle = 6.2831853 * noise(gl_FragCoord.xy) + (i < ${TAPS} ? 0.0 : 3.1415927);
        vec2 offset = mat2(cos(angle), sin(angle), -sin(angle), cos(angle)) * DISK_OFFSETS[i % ${TAPS}];
        vec3 tap = center + offset.x * t + offset.y * b;
        vec4 clip = projection * vec4(tap, 1.0);
        vec2 uv = clamp(0.5 * clip.xy / clip.w + 0.5, 0.0, 1.0);
        vec4 arriving = texture(irradiance, uv);
        // The others stand for taps where the screen has no surface, or one that is not near
        float is_near = arriving.a * step(abs(positionAt(uv).z - tap.z), 1.5 * length(offset) + 0.5);
        light += DISK_WEIGHTS[i % ${TAPS}] * arriving.rgb * is_near;
        seen += DISK_WEIGHTS[i % ${TAPS}] * is_near;
    }
    vec3 surface_albedo = vec3(SURFACE_ALBEDO_RED, SURFACE_ALBEDO_GREEN, SURFACE_ALBEDO_BLUE);
    vec3 diffuse = surface_albedo * (scattering ? light / seen : here.rgb);
    // A faint highlight by Blinn and Phong, of the light that arrives here
    vec3 halfway = normalize(toLight + normalize(-center));
    return diffuse + here.rgb * 0.24 * pow(max(dot(n, halfway), 0.0), 40.0);
}

void main() {
    vec4 here = texture(irradiance, at);
    vec3 background = mix(vec3(0.030, 0.034, 0.044), vec3(0.004), smoothstep(0.1, 0.8, length(at - 0.5)));
    gl_FragColor = vec4(here.a > 0.0 ? scattered(here) : background, 1.0);
    #include <tonemapping_fragment>
    #include <colorspace_fragment>
}`;
const uniforms = {
    irradiance: { value: irradiance.texture },
    depth: { value: irradiance.depthTexture },
    normal: { value: normal.texture },
    projection: { value: camera.projectionMatrix },
    viewFromClip: { value: camera.projectionMatrixInverse },
    toLight: { value: new THREE.Vector3() },
    scattering: { value: true },
};
const vertexShader = "out vec2 at; void main() { at = uv; gl_Position = vec4(position.xy, 0.0, 1.0); }";
const pass = new THREE.ShaderMaterial({ uniforms, vertexShader, depthTest: false });
const screen = new THREE.Mesh(new THREE.PlaneGeometry(2, 2), pass);
screen.frustumCulled = false;

function draw() {
    if (!pass.fragmentShader.includes("DISK_OFFSETS")) return;
    uniforms.toLight.value.copy(key.position).normalize().transformDirection(camera.matrixWorldInverse);
    for (const [into, material] of [[irradiance, white], [normal, normals]]) {
        scene.overrideMaterial = material;
        renderer.setRenderTarget(into);
        renderer.setClearColor(0, 0);
        renderer.clear();
        renderer.render(scene, camera);
    }
    renderer.setRenderTarget(null);
    renderer.render(screen, camera);
}

/** Writes the material's numbers into the shader, once a frame at most. */
let waits = false;
function changed() {
    if (waits) return;
    waits = true;
    requestAnimationFrame(() => {
        waits = false;
        const material = { surfaceAlbedo: albedo.numbers, mfp: mfp.numbers };
        uniforms.scattering.value = byId("scattering").checked;
        try {
            const disk = exportText({ to: "glsl", what: "disk", model: MODEL, taps: TAPS, ...material });
            pass.fragmentShader = disk + PASS;
            pass.needsUpdate = true;
            byId("message").textContent = "";
            plot(material);
            draw();
            document.body.dataset.drawn = JSON.stringify({ ...material, scattering: uniforms.scattering.value });
        } catch (error) {
            byId("message").textContent = error.message;
        }
    });
}

/** Draws 2πr R(r) of red, green and blue: the area below a curve is the surface albedo. */
function plot({ surfaceAlbedo, mfp }) {
    const canvas = byId("plot");
    const [width, height] = [(canvas.width = 2 * canvas.clientWidth), (canvas.height = 2 * canvas.clientHeight)];
    const [context, base, most] = [canvas.getContext("2d"), height - 30, 6 * Math.max(...mfp)];
    const radii = Float64Array.from({ length: 200 }, (_, i) => (most * (i + 0.5)) / 200);
    const curves = COLORS.map((_, i) => {
        const profile = new Profile({ model: MODEL, surfaceAlbedo: surfaceAlbedo[i], mfp: mfp[i] });
        const light = profile.pdf(radii).map((density) => density * profile.total);
        profile.free();
        return light;
    });
    const top = Math.max(...curves.map((light) => Math.max(...light)));
    const place = (light, i) => [(width * i) / 199, base - (0.95 * base * light) / top];
    context.globalCompositeOperation = "lighter";
    curves.forEach((curve, i) => {
        context.beginPath();
        curve.forEach((light, k) => context.lineTo(...place(light, k)));
        context.strokeStyle = context.fillStyle = COLORS[i];
        context.lineWidth = 4;
        context.stroke();
        context.lineTo(width, base);
        context.lineTo(0, base);
        context.globalAlpha = 0.25;
        context.fill();
        context.globalAlpha = 1;
    });
    context.fillStyle = "#8b909c";
    context.font = "22px system-ui, sans-serif";
    context.fillText("0", 0, height - 4);
    context.textAlign = "right";
    context.fillText(`r = ${most.toFixed(1)} mm`, width, height - 4);
}

function resized() {
    const { clientWidth: width, clientHeight: height } = byId("view");
    renderer.setSize(width, height);
    const size = renderer.getDrawingBufferSize(new THREE.Vector2());
    for (const each of [irradiance, normal]) each.setSize(size.x, size.y);
    camera.aspect = width / height;
    camera.updateProjectionMatrix();
    draw();
}

const [geometry] = await Promise.all([new PLYLoader().loadAsync("../../scenes/bust.ply"), init()]);
geometry.computeVertexNormals();
geometry.center();
geometry.computeBoundingBox();
geometry.scale(...Array(3).fill(HEIGHT / geometry.boundingBox.getSize(new THREE.Vector3()).y));
const bust = new THREE.Mesh(geometry, white);
bust.castShadow = bust.receiveShadow = true;
scene.add(bust);
new ResizeObserver(resized).observe(byId("view"));
resized();
// Nothing can be chosen before the module is there
byId("preset").append(...PRESETS.map((name) => new Option(name)));
byId("preset").onchange();
document.querySelector("aside").inert = false;
