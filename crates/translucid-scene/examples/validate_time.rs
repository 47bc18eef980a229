use std::time::Instant;
use translucid_scene::*;
fn main() {
    let path = std::env::args().nth(1).unwrap();
    let scene = load_scene(path.as_ref(), &LoadOptions::default(), &mut Vec::new()).unwrap();
    let count: usize = scene.objects.iter().map(|o| o.mesh.triangles.len()).sum();
    let mut best = f64::MAX;
    for _ in 0..40 {
        let start = Instant::now();
        scene.validate().unwrap();
        best = best.min(start.elapsed().as_secs_f64());
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let mut one = f64::MAX;
    for _ in 0..40 {
        let start = Instant::now();
        pool.install(|| scene.validate()).unwrap();
        one = one.min(start.elapsed().as_secs_f64());
    }
    let mut m = f64::MAX;
    for _ in 0..1000 {
        let start = Instant::now();
        scene.validate_material(0).unwrap();
        m = m.min(start.elapsed().as_secs_f64());
    }
    println!(
        "{count} triangles: {:.2} ms, one thread {:.2} ms; a material {:.2} us",
        best * 1e3,
        one * 1e3,
        m * 1e6
    );
}
