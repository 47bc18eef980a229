//! Distance of the mean over the two rings at a radius from the exitance at the radius itself.

use std::f64::consts::PI;

use translucid_reference::Incidence;
use translucid_reference::exact::HalfSpace;
use translucid_reference::walk::Layout;

/// The figures that `Layout::around` states.
#[test]
fn mean_over_rings_is_almost_the_value_at_their_center() {
    let radii = [0.001, 0.01, 0.1, 0.3, 1.0, 2.0, 2.5, 3.0, 5.0, 10.0, 20.0];
    let layout = Layout::around(&radii).unwrap();
    for incidence in [Incidence::NORMAL, Incidence::Cosine] {
        for alpha in [0.1, 0.5, 0.9, 0.99, 0.999] {
            let exact = HalfSpace::new(alpha, incidence).unwrap();
            for (index, &r) in radii.iter().enumerate() {
                let [inner, outer] = [3 * index, 3 * index + 2].map(|edge| layout.radii()[edge]);
                let energy = exact.enclosed(outer).value - exact.enclosed(inner).value;
                let mean = energy / (PI * (outer * outer - inner * inner));
                let bias = mean / exact.eval(r).value - 1.0;
                let most = if r <= 1.0 { 3e-4 * r } else { 1e-3 };
                assert!(bias > 0.0 && bias < most, "{incidence:?} α = {alpha}, r = {r}: {bias:e}");
            }
        }
    }
}
