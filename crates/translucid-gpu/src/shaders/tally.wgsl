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

fn count_exit(x: f32, y: f32, order: u32, side: u32) {
    let ring = bounds_below(0u, settings.radii, bitcast<u32>(plus(times(x, x), times(y, y))));
    let place = (side * (settings.radii + 1u) + ring) * settings.sectors + sector_of(x, y);
    let orders = settings.radii + 2u * (settings.sectors - 1u);
    let cell = 3u * (place * settings.order_bins + bounds_below(orders, settings.order_bins - 1u, order));
    atomicAdd(&cells[cell], 1u);
    let before = atomicAdd(&cells[cell + 1u], order);
    if (before + order < before) {
        atomicAdd(&cells[cell + 2u], 1u);
    }
}
