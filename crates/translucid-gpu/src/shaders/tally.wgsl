// Photons that left, counted.

// Number of bounds, from `first` on, that are at or below a number. Bounds are at least 0, so their bits are in their order.
fn bounds_below(first: u32, count: u32, number: u32) -> u32 {
    var low = 0u;
    var high = count;
    for (var i = 0u; i < 32u && low < high; i++) {
        let middle = (low + high) / 2u;
        if (bounds[first + middle] <= number) {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    return low;
}

// The sector of a place: half planes beside the x axis that it lies beyond.
fn sector_of(x: f32, y: f32) -> u32 {
    var low = 0u;
    var high = settings.sectors - 1u;
    for (var i = 0u; i < 32u && low < high; i++) {
        let middle = (low + high) / 2u;
        let bound = settings.radii + 2u * middle;
        let side = plus(times(bitcast<f32>(bounds[bound]), abs(y)), -times(bitcast<f32>(bounds[bound + 1u]), x));
        if (side > 0.0) {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    return low;
}

// x² + y² as a rounded number and the rest, to 2⁻³⁴ of it: rings may be a millionth of their radius wide. Where a square
// overflows, no number comes out, whose bits are above those of all bounds.
fn squared_distance(x: f32, y: f32) -> vec2f {
    let a = bitcast<f32>(bitcast<u32>(x) & 0xfffff000u);
    let b = bitcast<f32>(bitcast<u32>(y) & 0xfffff000u);
    // The squares of twelve bits are exact
    let p = times(a, a);
    let q = times(b, b);
    let upper = plus(p, q);
    let lost = plus(min(p, q), -plus(upper, -max(p, q)));
    let lower = plus(times(plus(x, -a), plus(x, a)), times(plus(y, -b), plus(y, b)));
    let rest = plus(lost, lower);
    let sum = plus(upper, rest);
    return vec2f(sum, plus(rest, -plus(sum, -upper)));
}

fn ring_of(x: f32, y: f32) -> u32 {
    let square = squared_distance(x, y);
    let rests = settings.radii + 2u * (settings.sectors - 1u) + settings.order_bins - 1u;
    let ring = bounds_below(0u, settings.radii, bitcast<u32>(square.x));
    if (ring == 0u || bounds[ring - 1u] != bitcast<u32>(square.x)) {
        return ring;
    }
    return select(ring, ring - 1u, square.y < bitcast<f32>(bounds[rests + ring - 1u]));
}

fn count_exit(x: f32, y: f32, order: u32, side: u32) {
    let ring = ring_of(x, y);
    let place = (side * (settings.radii + 1u) + ring) * settings.sectors + sector_of(x, y);
    let orders = settings.radii + 2u * (settings.sectors - 1u);
    let cell = 3u * (place * settings.order_bins + bounds_below(orders, settings.order_bins - 1u, order));
    atomicAdd(&cells[cell], 1u);
    let before = atomicAdd(&cells[cell + 1u], order);
    if (before + order < before) {
        atomicAdd(&cells[cell + 2u], 1u);
    }
}
