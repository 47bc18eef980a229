//! `translucid export`: what every combination prints, and what wrong input is told.

use crate::common::{run, stderr, stdout};

fn here() -> std::path::PathBuf {
    std::env::temp_dir()
}

#[test]
fn every_text_says_where_it_comes_from() {
    for language in ["wgsl", "glsl", "hlsl", "msl", "osl", "c", "cpp"] {
        for model in ["normalized-diffusion", "normalized-diffusion-refined", "normalized-diffusion-oblique"]
        {
            let words = format!("export --to {language} --what profile,sampler --model {model}");
            let text = stdout(&here(), &words);
            for part in ["Christensen", "SPDX-License-Identifier: MIT-0", "Largest relative errors"] {
                let has_it = text.contains(part) || model.ends_with("oblique");
                assert!(has_it, "{words}: no {part} in {text}");
            }
            assert!(text.contains(&format!("translucid {words}")), "{text}");
        }
    }
}

#[test]
fn a_material_becomes_constants() {
    let text = stdout(&here(), "export --to c --what profile --preset marble --unit cm");
    assert!(text.contains("static const float TRANSLUCID_SURFACE_ALBEDO_RED = 0.93115"), "{text}");
    assert!(text.contains("static const float TRANSLUCID_MEAN_FREE_PATH_RED = 0.045618"), "{text}");
    let text = stdout(&here(), "export --to glsl --what profile --surface-albedo 0.8 --mfp 2.2,1.1,1.1");
    assert!(text.contains("const float WIDTH_RED = 2.0;"), "{text}");
}

#[test]
fn models_without_a_closed_form_are_sums_of_a_material() {
    let text = stdout(&here(), "export --to hlsl --what sampler --model gaussians --preset skin1");
    assert!(text.contains("Gaussians GaussiansOfChannel(float channel) {"), "{text}");
    assert!(text.contains("float GaussiansSample(Gaussians terms, float u) {"), "{text}");
    let words = "export --to c --what profile --model dipole --surface-albedo 0.8,0.5,0.5 --mfp 1";
    let text = stdout(&here(), words);
    assert!(text.contains("the least squares fit to dipole."), "{text}");
    assert!(text.contains("TranslucidGaussians translucid_gaussians_of_channel(float channel) {"));
    // Refined diffusion has its own, and both go into one text
    let words = "export --to wgsl --what profile --model exact,gaussians,normalized-diffusion-refined \
                 --surface-albedo 0,0.5,1 --mfp 1";
    let text = stdout(&here(), words);
    for name in ["fn exponentials_eval", "fn gaussians_eval", "fn refined_eval"] {
        assert_eq!(text.matches(name).count(), 1, "{text}");
    }
}

#[test]
fn tables_are_of_a_material() {
    let text = stdout(&here(), "export --to hlsl --what disk,kernel --preset skin1 --taps 9");
    for part in ["static const float2 DISK_OFFSETS[9] = {", "static const float4 KERNEL[9] = {"] {
        assert!(text.contains(part), "{text}");
    }
    let text = stdout(&here(), "export --to c --what lut --model exact --preset skin1 --size 5x3");
    assert!(text.contains("static const float TRANSLUCID_LUT[15][3] = {"), "{text}");
    let text = stdout(&here(), "export --to glsl --what transmittance --preset skin1 --eta 1.4 --size 9x2");
    for part in [
        "const vec3 TRANSMITTANCE[9] = ",
        "L. G. Henyey",
        "Column i is the thickness",
        "Thicker slabs pass less",
    ] {
        assert!(text.contains(part), "{text}");
    }
    let text = stdout(&here(), "export --to c --what transmittance --preset skin1 --size 9x2");
    assert!(text.contains("#ifndef TRANSLUCID_TRANSMITTANCE_H"), "{text}");
    let folder = tempfile::tempdir().unwrap();
    for (what, format) in
        ["lut", "transmittance"].iter().flat_map(|what| ["exr", "png", "dds", "npz"].map(|f| (what, f)))
    {
        let words =
            format!("export --to {format} --what {what} --preset skin1 --size 9x5 -o {what}.{format}");
        stdout(folder.path(), &words);
        assert!(folder.path().join(format!("{what}.{format}")).metadata().unwrap().len() > 100);
    }
}

/// Heads of exports say which mean free path is meant: a diffuse one is another by configuration and by fit.
#[test]
fn diffuse_lengths_say_which_mean_free_paths_they_mean() {
    let words = "export --to c --what profile --surface-albedo 0.8,0.8,0.5 --dmfp 6,3,6";
    let text = stdout(&here(), words);
    // 6 over 7.40424, 5.97804 and 7.61772
    for part in [
        "0.8103, 0.4052, 2.5077  a perpendicular pencil beam, exactly (meant here)",
        "1.0037, 0.5018, 2.9658  light from all directions, exactly\n",
        "0.7518, 0.3759,",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let text = stdout(&here(), &format!("{words} --configuration diffuse"));
    assert!(text.contains("from all directions, exactly (meant here)"), "{text}");
    assert!(
        !stdout(&here(), "export --to c --what profile --surface-albedo 0.8 --mfp 1").contains("exactly")
    );
}

#[test]
fn materialx_has_nodes_and_materials() {
    let words = "export --to materialx --what profile,material --surface-albedo 0.8 --mfp 0.5,2,1";
    let text = stdout(&here(), words);
    for part in [
        "<nodedef name=\"ND_translucid_burley_eval\"",
        "<nodegraph name=\"NG_translucid_burley_eval\"",
        "<open_pbr_surface",
        "<input name=\"subsurface_radius\" type=\"float\" value=\"2.0\" />",
        "value=\"0.25, 1.0, 0.5\"",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let text = stdout(&here(), "export --to materialx --what material --preset porcelain --unit cm");
    for part in [
        "<input name=\"specular_ior\" type=\"float\" value=\"1.55\" />",
        "<input name=\"specular_roughness\" type=\"float\" value=\"0.3\" />",
        "<input name=\"coat_roughness\" type=\"float\" value=\"0.03\" />",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    assert!(!text.contains("transmission_weight"), "{text}");
    let clear = stdout(&here(), "export --to materialx --what material --preset merlot --unit cm");
    assert!(clear.contains("<input name=\"transmission_weight\" type=\"float\" value=\"1.0\" />"), "{clear}");
    assert!(clear.contains("<input name=\"subsurface_weight\" type=\"float\" value=\"0.0\" />"), "{clear}");
    // Two hyphens end a comment in XML
    let comment = text.split("<!--").nth(1).and_then(|rest| rest.split("-->").next()).unwrap();
    assert!(!comment.contains("--"), "{comment}");
}

#[test]
fn wrong_input_is_told_what_is_allowed() {
    for (words, message) in [
        ("--to cobol --what profile", "[possible values: wgsl"),
        ("--to c --what profil", "[possible values: profile"),
        (
            "--to c --what profile --model dipole",
            "--model is dipole, but must be a closed form: normalized-diff",
        ),
        (
            "--to c --what profile --model dipole,exact,gaussians --preset skin1",
            "--model is gaussians, but must be in a text of its own: the sum of another is of Gaussians, too",
        ),
        (
            "--to c --what profile --model gaussians --surface-albedo 1 --dmfp 1",
            "--surface-albedo is 1, but must be less than 1 with a dmfp",
        ),
        ("--to c --what profile --g 0.5", "--g is 0.5, but must be 0 without inversion"),
        ("--to c --what inversion --g 0.99", "--g is 0.99, but must be in [-0.95, 0.95]"),
        ("--to c --what inversion --eta 4", "--eta is 4, but must be in [1, 3]"),
        ("--to c --what fresnel --eta nan", "--eta is NaN, but must be in [0.05, 20]"),
        ("--to c --what profile --model none", "the model none has no profile"),
        ("--to c --what profile --preset marbel", "did you mean \"marble\""),
        ("--to c --what profile --surface-albedo 0.5", "--mfp or --dmfp is missing"),
        (
            "--to c --what profile --surface-albedo 1.5 --mfp 1",
            "--surface-albedo is 1.5, but must be in [0, 1]",
        ),
        ("--to c --what profile --surface-albedo 0.5 --mfp 0", "--mfp is 0, but must be in [1e-18, 1e18]"),
        ("--to c --what profile --surface-albedo 0.5 --dmfp -1", "--dmfp is -1, but must be in"),
        ("--to c --what profile --surface-albedo 0.5 --mfp nan", "--mfp is NaN, but must be in"),
        (
            "--to c --what profile --surface-albedo 0.5,0.4 --mfp 1",
            "--surface-albedo has 2 numbers, but must",
        ),
        (
            "--to c --what disk",
            "--what is disk, but must be a profile, sampler or other function, as there is no material: name one by a preset",
        ),
        (
            "--to osl --what disk --preset skin1",
            "--to is osl, but must be one of wgsl, glsl, hlsl, msl, c, cpp for disk",
        ),
        (
            "--to wgsl --what lut --preset skin1",
            "--to is wgsl, but must be one of c, cpp, exr, png, dds, npz for lut",
        ),
        ("--to exr --what profile", "--to is exr, but must be one of"),
        (
            "--to osl --what transmittance --preset skin1",
            "--to is osl, but must be one of wgsl, glsl, hlsl, msl, c, cpp, exr, png, dds, npz for transmittance",
        ),
        ("--to c --what transmittance", "--what is transmittance, but must be a profile, sampler or other"),
        (
            "--to c --what transmittance --preset skin1 --most-thickness 0",
            "--most-thickness is 0, but must be in (0, 1e18]",
        ),
        ("--to c --what transmittance --preset skin1 --eta 4", "--eta is 4, but must be in [1, 3]"),
        ("--to c --what material --preset skin1", "--to is c, but must be one of materialx for material"),
        (
            "--to materialx --what fresnel --eta 1.4",
            "--eta is 1.4, but must be 1 without inversion, transmittance or moments",
        ),
        ("--to materialx --what material", "--what is material, but must be a profile, sampler or other"),
        ("--to materialx --what profile --preset skin1", "--what is functions, but must be material too"),
        ("--to c --what disk --preset skin1 --taps 2", "--taps is 2, but must be in [3, 1024]"),
        (
            "--to c --what transmittance --preset skin1 --model dipole",
            "--model is for subjects with a profile, but --what is transmittance",
        ),
        ("--to c --what fresnel,inversion --model exact", "but --what is fresnel,inversion"),
        (
            "--to c --what profile --most-thickness 3",
            "--most-thickness is for transmittance, but --what is profile",
        ),
        ("--to c --what profile --size 3x3", "--size is for lut and transmittance, but --what is profile"),
        ("--to c --what lut --preset skin1 --taps 9", "--taps is for disk and kernel, but --what is lut"),
        (
            "--to c --what disk --preset skin1 --most-curvature 1",
            "--most-curvature is for lut, but --what is disk",
        ),
        ("--to c --what lut --preset skin1 --size 1x5", "--size is 1, but must be in [2, 1024] each"),
        ("--to c --what lut --preset skin1 --size 5", "two whole numbers with an x between"),
        (
            "--to c --what lut --preset skin1 --most-curvature 0",
            "--most-curvature is 0, but must be in (0, 1e18]",
        ),
        (
            "--to c --what disk --preset skin1 --model exact,dipole",
            "--model is exact,dipole, but must be one",
        ),
        ("--to c --what profile -o no/such/directory.h", "no/such"),
    ] {
        let output = run(&here(), &format!("export {words}"));
        assert_eq!(output.status.code(), Some(2), "{words}");
        assert!(stderr(&output).contains(message), "{words}: {}", stderr(&output));
        assert!(output.stdout.is_empty());
    }
}
