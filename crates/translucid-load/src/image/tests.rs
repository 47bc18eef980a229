use translucid_testing::mutants;

use super::*;
use crate::result::Result;

fn decoded(bytes: &[u8]) -> Result<Image> {
    decode_image(&Place::file(Path::new("a.png")), bytes, ColorSpace::Srgb, &mut Vec::new())
}

fn is_sound(image: &Image) -> bool {
    image.validate().is_ok()
}

#[test]
fn image_of_unknown_format_is_refused_with_its_name() {
    for (bytes, part) in [
        (&b""[..], "is empty"),
        (b"\x89PN", "not an image of a known format"),
        (b"GIF89a", "is a GIF, which cannot be read"),
    ] {
        let message = decoded(bytes).unwrap_err().to_string();
        assert!(message.starts_with("a.png: ") && message.contains(part), "{message}");
    }
    let missing = load_image(Path::new("no/such.png"), ColorSpace::Srgb, &mut Vec::new());
    assert!(missing.unwrap_err().to_string().starts_with("no/such.png: cannot be read"));
}

#[test]
fn image_survives_any_mutation() {
    let jpegs: [&[u8]; 3] = [
        include_bytes!("../../tests/data/color.jpg"),
        include_bytes!("../../tests/data/progressive.jpg"),
        include_bytes!("../../tests/data/cmyk.jpg"),
    ];
    let others = [png::example(), exr::example(), radiance::example(), tiff::example()];
    for file in jpegs.map(<[u8]>::to_vec).into_iter().chain(others) {
        assert!(decoded(&file).is_ok());
        for mutant in mutants(&file, 2_000) {
            assert!(decoded(&mutant).map_or(true, |image| is_sound(&image)));
        }
    }
}

/// Codes whose colors are far from those of the same codes in sRGB, and a gray.
const CODES: [u8; 9] = [200, 100, 50, 90, 140, 120, 128, 128, 128];

fn profile_of(profile: &moxcms::ColorProfile) -> Vec<u8> {
    profile.encode().unwrap()
}

fn png_with(depth: u16, change: impl FnOnce(&mut ::png::Info<'_>)) -> Vec<u8> {
    let mut info = ::png::Info::with_size(3, 1);
    info.color_type = ::png::ColorType::Rgb;
    info.bit_depth = if depth == 8 { ::png::BitDepth::Eight } else { ::png::BitDepth::Sixteen };
    change(&mut info);
    let mut bytes = Vec::new();
    let mut writer = ::png::Encoder::with_info(&mut bytes, info).unwrap().write_header().unwrap();
    let wide: Vec<u8> = CODES.iter().flat_map(|code| [*code; 2]).collect();
    writer.write_image_data(if depth == 8 { &CODES } else { &wide }).unwrap();
    drop(writer);
    bytes
}

/// A PNG with a chunk behind its header.
fn png_with_chunk(name: &[u8; 4], data: &[u8]) -> Vec<u8> {
    let mut bytes = png_with(8, |_| {});
    let checksum = [&name[..], data].concat().iter().fold(!0_u32, |mut sum, byte| {
        sum ^= u32::from(*byte);
        (0..8).for_each(|_| sum = if sum & 1 == 1 { sum >> 1 ^ 0xedb8_8320 } else { sum >> 1 });
        sum
    });
    let length = u32::try_from(data.len()).unwrap().to_be_bytes();
    let chunk = [&length[..], name, data, &(!checksum).to_be_bytes()].concat();
    bytes.splice(33..33, chunk);
    bytes
}

fn tiff_with(profile: &[u8], depth: u16) -> Vec<u8> {
    use ::tiff::encoder::{TiffEncoder, colortype};
    let mut bytes = std::io::Cursor::new(Vec::new());
    let mut encoder = TiffEncoder::new(&mut bytes).unwrap();
    if depth == 8 {
        let mut image = encoder.new_image::<colortype::RGB8>(3, 1).unwrap();
        image.encoder().write_tag(::tiff::tags::Tag::IccProfile, profile).unwrap();
        image.write_data(&CODES).unwrap();
    } else {
        let mut image = encoder.new_image::<colortype::RGB16>(3, 1).unwrap();
        image.encoder().write_tag(::tiff::tags::Tag::IccProfile, profile).unwrap();
        image.write_data(&CODES.map(|code| 257 * u16::from(code))).unwrap();
    }
    bytes.into_inner()
}

const JPEG: &[u8] = include_bytes!("../../tests/data/color.jpg");

/// The JPEG with segments behind its first marker.
fn jpeg_with(segments: &[(u8, Vec<u8>)]) -> Vec<u8> {
    let mut bytes = JPEG[..2].to_vec();
    for (marker, data) in segments {
        bytes.extend([0xff, *marker]);
        bytes.extend(u16::try_from(data.len() + 2).unwrap().to_be_bytes());
        bytes.extend(data);
    }
    bytes.extend(&JPEG[2..]);
    bytes
}

/// EXIF of an orientation, and of a color space if it is not 0, with the name of an interoperability.
fn exif(orientation: u8, color_space: u16, interoperability: Option<&[u8; 3]>) -> Vec<u8> {
    let entry = |tag: u16, kind: u16, count: u32, value: u32| {
        [&tag.to_le_bytes()[..], &kind.to_le_bytes(), &count.to_le_bytes(), &value.to_le_bytes()].concat()
    };
    let name = interoperability.map_or(0, |name| u32::from_le_bytes([name[0], name[1], name[2], 0]));
    [
        b"II*\0\x08\0\0\0\x02\0".to_vec(),
        entry(274, 3, 1, orientation.into()),
        entry(0x8769, 4, 1, 38),
        vec![0; 4],
        vec![2, 0],
        entry(0xa001, 3, 1, color_space.into()),
        entry(0xa005, 4, 1, 68),
        vec![0; 4],
        vec![1, 0],
        entry(1, 2, 4, name),
        vec![0; 4],
    ]
    .concat()
}

fn photograph(bytes: &[u8], color_space: ColorSpace) -> Result<(Image, Vec<String>)> {
    let mut warnings = Vec::new();
    let place = Place::file(Path::new("a.png"));
    let kind = ImageKind::Color(color_space);
    let image = decode_for(Use::Photograph, &place, bytes, kind, &mut warnings)?;
    Ok((image, warnings.iter().map(ToString::to_string).collect()))
}

/// Asserts linear values of pixels by the sRGB codes that lcms gives, up to its rounding and beyond its clipping.
fn assert_codes(image: &Image, expected: &[[u8; 3]], what: &str) {
    for (x, expected) in expected.iter().enumerate() {
        let texel = image.texel(x as u32, 0);
        for (value, expected) in texel.into_iter().zip(expected) {
            let value = value.clamp(0.0, 1.0);
            let code =
                if value <= 0.003_130_8 { 12.92 * value } else { 1.055 * value.powf(1.0 / 2.4) - 0.055 };
            assert!((255.0 * code - f32::from(*expected)).abs() < 1.2, "{what}: {texel:?} for {expected:?}");
        }
    }
}

/// The codes are those of Pillow's `ImageCms` (lcms 2.17) to its sRGB, relative colorimetric.
#[test]
fn profiles_count_in_every_format() {
    let mut linear = moxcms::ColorProfile::new_srgb();
    let curve = Some(moxcms::ToneReprCurve::Lut(vec![]));
    (linear.red_trc, linear.green_trc, linear.blue_trc) = (curve.clone(), curve.clone(), curve);
    linear.cicp = None;
    for (what, profile, expected) in [
        ("P3", moxcms::ColorProfile::new_display_p3(), [[215, 93, 31], [73, 142, 119], [128; 3]]),
        ("ProPhoto", moxcms::ColorProfile::new_pro_photo_rgb(), [[255, 80, 46], [0, 166, 136], [146; 3]]),
        ("Adobe", moxcms::ColorProfile::new_adobe_rgb(), [[227, 100, 42], [53, 141, 120], [129; 3]]),
        ("linear", linear, [[229, 168, 122], [160, 196, 182], [188; 3]]),
        ("sRGB", moxcms::ColorProfile::new_srgb(), [[200, 100, 50], [90, 140, 120], [128; 3]]),
    ] {
        let profile = profile_of(&profile);
        for depth in [8, 16] {
            let file = png_with(depth, |info| info.icc_profile = Some(profile.clone().into()));
            assert_codes(&photograph(&file, ColorSpace::Srgb).unwrap().0, &expected, what);
            let file = tiff_with(&profile, depth);
            assert_codes(&photograph(&file, ColorSpace::Srgb).unwrap().0, &expected, what);
        }
        let part = |number: u8, data: &[u8]| [&b"ICC_PROFILE\0"[..], &[number, 2], data].concat();
        let (first, second) = profile.split_at(profile.len() / 2);
        let file = jpeg_with(&[(0xe2, part(1, first)), (0xe2, part(2, second))]);
        let image = photograph(&file, ColorSpace::Srgb).unwrap().0;
        let near = image.texel(4, 8)[0]
            - photograph(
                &png_with(8, |info| {
                    info.icc_profile = Some(profile.clone().into());
                }),
                ColorSpace::Srgb,
            )
            .unwrap()
            .0
            .texel(0, 0)[0];
        assert!(near.abs() < 0.03, "{what}: {near}");
    }
}

#[test]
fn wide_colors_are_negative_and_textures_say_so() {
    let profile = profile_of(&moxcms::ColorProfile::new_pro_photo_rgb());
    let file = png_with(16, |info| info.icc_profile = Some(profile.into()));
    let (image, warnings) = photograph(&file, ColorSpace::Srgb).unwrap();
    assert!(image.texel(1, 0)[0] < -0.01 && warnings.is_empty(), "{:?} {warnings:?}", image.texel(1, 0));
    let mut warnings = Vec::new();
    decode_image(&Place::file(Path::new("a.png")), &file, ColorSpace::Srgb, &mut warnings).unwrap();
    assert!(warnings[0].message.contains("33.3 % of the pixels have colors of"), "{warnings:?}");
}

#[test]
fn data_and_gltf_know_no_profiles() {
    let profile = profile_of(&moxcms::ColorProfile::new_pro_photo_rgb());
    let file = png_with(8, |info| info.icc_profile = Some(profile.into()));
    for (used_as, space) in [(Use::Scene, ColorSpace::Linear), (Use::Gltf, ColorSpace::Srgb)] {
        let mut warnings = Vec::new();
        let place = Place::file(Path::new("a.png"));
        let image = decode_for(used_as, &place, &file, ImageKind::Plain(space), &mut warnings).unwrap();
        assert!(matches!(&image.pixels, Pixels::Byte(pixels) if pixels[0] == [200, 100, 50, 255]));
        assert!(image.color_space == space && warnings.is_empty(), "{warnings:?}");
    }
}

#[test]
fn linear_replaces_a_curve_but_no_primaries() {
    let profile = profile_of(&moxcms::ColorProfile::new_display_p3());
    let file = png_with(16, |info| info.icc_profile = Some(profile.into()));
    let (image, warnings) = photograph(&file, ColorSpace::Linear).unwrap();
    // SMPTE EG 432-1 to Rec. 709
    let red = (200.0 * 1.224_94 - 100.0 * 0.224_94) / 255.0;
    assert!((image.texel(0, 0)[0] - red).abs() < 1e-3, "{:?}", image.texel(0, 0));
    assert!(warnings[0].contains("taken as linear, although \"Display P3\" has a curve"), "{warnings:?}");
}

#[test]
fn profiles_that_do_not_fit_are_left_out_by_name() {
    let gray = profile_of(&moxcms::ColorProfile::new_gray_with_gamma(1.8));
    for (profile, part) in [(gray, "is for colors of the kind Gray"), (vec![7; 300], "is damaged")] {
        let (image, warnings) = photograph(&tiff_with(&profile, 8), ColorSpace::Srgb).unwrap();
        assert_codes(&image, &[[200, 100, 50]], part);
        assert!(warnings[0].contains(part) && warnings[0].contains("are taken as sRGB"), "{warnings:?}");
    }
}

#[test]
fn chunks_of_png_count_in_their_order() {
    let gamma = |gamma: u32| gamma.to_be_bytes();
    for (file, expected) in [
        (png_with_chunk(b"gAMA", &gamma(100_000)), [[229, 168, 122], [160, 196, 182], [188; 3]]),
        (png_with_chunk(b"gAMA", &gamma(45_455)), [[200, 100, 50], [90, 140, 120], [128; 3]]),
        (png_with_chunk(b"cICP", &[12, 13, 0, 1]), [[215, 93, 31], [73, 142, 119], [128; 3]]),
        (png_with_chunk(b"cICP", &[1, 8, 0, 1]), [[229, 168, 122], [160, 196, 182], [188; 3]]),
        (png_with_chunk(b"sRGB", &[0]), [[200, 100, 50], [90, 140, 120], [128; 3]]),
    ] {
        assert_codes(&photograph(&file, ColorSpace::Srgb).unwrap().0, &expected, "PNG");
    }
    // Unspecified is what the other chunks say, or else sRGB: ffmpeg's files of OpenEXR
    let with_gamma = |cicp: [u8; 4], gamma: u32| {
        let cicp = png_with_chunk(b"cICP", &cicp);
        let gamma = png_with_chunk(b"gAMA", &gamma.to_be_bytes());
        [&cicp[..49], &gamma[33..49], &cicp[49..]].concat()
    };
    for (file, expected, part) in [
        (
            with_gamma([2, 8, 0, 1], 100_000),
            [[229, 168, 122]],
            "primaries open: they are taken as those of Rec. 709",
        ),
        (with_gamma([12, 2, 0, 1], 45_455), [[215, 93, 31]], "curve open: that of its gAMA counts"),
        (png_with_chunk(b"cICP", &[1, 2, 0, 1]), [[200, 100, 50]], "curve open: it is taken as that of sRGB"),
        (with_gamma([2, 2, 0, 1], 100_000), [[229, 168, 122]], ""),
    ] {
        let (image, warnings) = photograph(&file, ColorSpace::Srgb).unwrap();
        assert_codes(&image, &expected, part);
        assert!(part.is_empty() || warnings[0].contains(part), "{warnings:?}");
    }
    let p3 = [31_270_u32, 32_900, 68_000, 32_000, 26_500, 69_000, 15_000, 6_000].map(u32::to_be_bytes);
    let file = png_with_chunk(b"cHRM", &p3.concat());
    assert_codes(&photograph(&file, ColorSpace::Srgb).unwrap().0, &[[215, 93, 31]], "cHRM");
    for (code, part) in
        [([9, 16, 0, 1], "coded by PQ"), ([9, 18, 0, 1], "coded by HLG"), ([1, 13, 0, 0], "narrow")]
    {
        let message = photograph(&png_with_chunk(b"cICP", &code), ColorSpace::Srgb).unwrap_err().to_string();
        assert!(message.contains(part), "{message}");
    }
}

#[test]
fn exif_turns_pictures_and_names_adobe_rgb() {
    let app1 = |exif: Vec<u8>| jpeg_with(&[(0xe1, [b"Exif\0\0".to_vec(), exif].concat())]);
    let upright = photograph(JPEG, ColorSpace::Srgb).unwrap().0;
    let turned = photograph(&app1(exif(6, 1, None)), ColorSpace::Srgb).unwrap().0;
    assert_eq!([turned.width, turned.height], [upright.height, upright.width]);
    assert_eq!(turned.texel(upright.height - 1, 3), upright.texel(3, 0));
    let png = photograph(&png_with_chunk(b"eXIf", &exif(2, 1, None)), ColorSpace::Srgb).unwrap().0;
    assert_codes(&png, &[[128; 3], [90, 140, 120], [200, 100, 50]], "mirrored");

    let adobe = photograph(&app1(exif(1, 0xffff, Some(b"R03"))), ColorSpace::Srgb).unwrap().0;
    assert!(adobe.texel(4, 8)[0] > upright.texel(4, 8)[0] + 0.1);
    let (_, warnings) = photograph(&app1(exif(1, 0xffff, None)), ColorSpace::Srgb).unwrap();
    assert!(warnings[0].contains("\"uncalibrated\": its numbers are taken as sRGB"), "{warnings:?}");

    let place = Place::file(Path::new("a.jpg"));
    let mut warnings = Vec::new();
    let kind = ImageKind::Plain(ColorSpace::Srgb);
    let gltf = decode_for(Use::Gltf, &place, &app1(exif(6, 1, None)), kind, &mut warnings).unwrap();
    assert_eq!([gltf.width, gltf.height], [upright.width, upright.height]);
    assert!(warnings[0].message.contains("its orientation 6 is passed over"), "{warnings:?}");
}

#[test]
fn other_formats_are_called_by_name() {
    let refused = |name: &str, bytes: &[u8]| {
        let place = Place::file(Path::new(name));
        decode_image(&place, bytes, ColorSpace::Srgb, &mut Vec::new()).unwrap_err()
    };
    for (bytes, part) in [
        (&b"\0\0\0\x20ftypheic"[..], "is a HEIC"),
        (b"\0\0\0\x20ftypavif", "is an AVIF"),
        (b"8BPS\0\x01", "is a Photoshop document"),
        (b"\xff\x0a\0", "is a JPEG XL"),
        (b"BM1234", "is a BMP"),
    ] {
        let error = refused("a.x", bytes);
        assert!(error.to_string().contains(part), "{error}");
        assert!(error.help.unwrap().contains("oiiotool"));
    }
    assert!(refused("a.tga", b"\0\0\x02\0\0").to_string().contains("is a TGA"));
    for (bytes, part) in [
        (&b"FUJIFILMCCD-RAW 0201"[..], "raw file (RAF)"),
        (b"\0\0\0\x18ftypcrx \0", "raw file (CR3)"),
        (b"IIRO\x08\0\0\0", "raw file (ORF)"),
    ] {
        let error = refused("a.raw", bytes);
        assert!(error.to_string().contains(part), "{error}");
        assert!(error.help.unwrap().contains("dcraw -4 -T -o 0 -r 1 1 1 1 a.raw"));
    }
}
