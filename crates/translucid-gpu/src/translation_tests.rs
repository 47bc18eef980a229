//! The kernels in the languages of systems that have no Vulkan: what wgpu does there when it makes pipelines, on any system.

use naga::ShaderStage::Compute;
use naga::back::pipeline_constants::process_overrides;
use naga::back::{hlsl, msl};
use naga::valid::{Capabilities, ValidationFlags, Validator};

use crate::{device, program};

/// DirectX 12 and Metal take every kernel, as far as naga knows: both texts are written without a fault.
#[test]
fn kernels_are_written_for_directx_and_metal() {
    for (text, kernels) in [(program::text(), program::KERNELS.len()), (device::SHADERS.concat(), 1)] {
        let module = naga::front::wgsl::parse_str(&text).unwrap();
        let info = Validator::new(ValidationFlags::all(), Capabilities::all()).validate(&module).unwrap();
        assert_eq!(module.entry_points.len(), kernels);
        let names = module.overrides.iter().filter_map(|(_, constant)| constant.name.clone());
        let constants =
            names.map(|name| if name == "group_size" { (name, 64.0) } else { (name, 1.0) }).collect();
        for entry in &module.entry_points {
            let kernel = Some((Compute, entry.name.clone()));
            let (module, info) =
                process_overrides(&module, &info, Some((Compute, &entry.name)), &constants).unwrap();
            let mut directx = String::new();
            let (options, pipeline) =
                (hlsl::Options::default(), hlsl::PipelineOptions { entry_point: kernel.clone() });
            let written = hlsl::Writer::new(&mut directx, &options, &pipeline).write(&module, &info, None);
            let names = written.unwrap_or_else(|fault| panic!("{}: {fault}", entry.name)).entry_point_names;
            assert!(names[0].as_ref().is_ok_and(|name| directx.contains(name)), "{names:?}");

            let options =
                msl::Options { lang_version: (2, 1), fake_missing_bindings: true, ..Default::default() };
            let pipeline = msl::PipelineOptions { entry_point: kernel, ..Default::default() };
            let (metal, written) = msl::write_string(&module, &info, &options, &pipeline)
                .unwrap_or_else(|fault| panic!("{}: {fault}", entry.name));
            let name = &written.entry_point_names[0];
            assert!(name.as_ref().is_ok_and(|name| metal.contains(name)), "{name:?}");
        }
    }
}
