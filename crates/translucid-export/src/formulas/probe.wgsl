// Three numbers, for red, green, blue.
struct RedGreenBlue {
    red: f32,
    green: f32,
    blue: f32,
}

// Three numbers, for red, green, blue.
fn channels(red: f32, green: f32, blue: f32) -> RedGreenBlue {
    var three: RedGreenBlue;
    three.red = red;
    three.green = green;
    three.blue = blue;
    return three;
}

// A segment from start to end, in the frame of the exit point x_o: z is the geometric normal, x and y are tangents.
struct Segment {
    start_x: f32,
    start_y: f32,
    start_z: f32,
    end_x: f32,
    end_y: f32,
    end_z: f32,
}

// Step 1. Choose a segment, for four random numbers in [0, 1).
//
// widths are the d of each channel, in [1e-6, 1e6] here; chances, of sum 1, say how often each is chosen: in proportion to the surface albedo
// times the path's throughput serves well. most_radius bounds the search: burley_quantile(0.999, greatest width), say.
fn probe_segment(widths: RedGreenBlue, chances: RedGreenBlue, most_radius: f32, u_axis: f32, u_channel: f32, u_radius: f32, u_turn: f32) -> Segment {
    // A channel by its chance, and a radius of its profile, which ends at most_radius
    let late: f32 = select(widths.blue, widths.green, u_channel < chances.red + chances.green);
    let d: f32 = select(late, widths.red, u_channel < chances.red);
    let r: f32 = min(burley_quantile(u_radius * burley_cdf(most_radius, d), d), most_radius);
    let angle: f32 = 2.0 * ${pi} * u_turn;
    let p: f32 = r * cos(angle);
    let q: f32 = r * sin(angle);
    // Both ends are on the ball of most_radius around x_o, whichever the axis
    let h: f32 = sqrt((most_radius - r) * (most_radius + r));
    // Half of the segments go along the normal, a quarter along each tangent
    var segment: Segment;
    if (u_axis < 0.5) {
        segment.start_x = p;
        segment.start_y = q;
        segment.start_z = h;
        segment.end_x = p;
        segment.end_y = q;
        segment.end_z = -h;
    } else if (u_axis < 0.75) {
        segment.start_x = h;
        segment.start_y = p;
        segment.start_z = q;
        segment.end_x = -h;
        segment.end_y = p;
        segment.end_z = q;
    } else {
        segment.start_x = q;
        segment.start_y = h;
        segment.start_z = p;
        segment.end_x = q;
        segment.end_y = -h;
        segment.end_z = p;
    }
    return segment;
}

// Density per area, on a plane across the axis, of segments at the distance r from x_o.
fn probe_mixture(widths: RedGreenBlue, chances: RedGreenBlue, most_radius: f32, r: f32) -> f32 {
    return chances.red * burley_pdf_area(r, widths.red) / burley_cdf(most_radius, widths.red)
        + chances.green * burley_pdf_area(r, widths.green) / burley_cdf(most_radius, widths.green)
        + chances.blue * burley_pdf_area(r, widths.blue) / burley_cdf(most_radius, widths.blue);
}

// Step 2. Intersect the segment with the object, and sum over ALL hits x_i, each divided by this density per area of
// finding it: over three axes and three channels, with the PROJECTED distance of each axis in the channel's profile.
//
// (x, y, z) is x_i - x_o and (n_x, n_y, n_z) the geometric normal at x_i, in the frame of x_o. Do not pick one hit at
// random and multiply by their number: together with this density that is biased.
fn probe_density(widths: RedGreenBlue, chances: RedGreenBlue, most_radius: f32, x: f32, y: f32, z: f32, n_x: f32, n_y: f32, n_z: f32) -> f32 {
    let along_z: f32 = 0.5 * abs(n_z) * probe_mixture(widths, chances, most_radius, sqrt(x * x + y * y));
    let along_x: f32 = 0.25 * abs(n_x) * probe_mixture(widths, chances, most_radius, sqrt(y * y + z * z));
    let along_y: f32 = 0.25 * abs(n_y) * probe_mixture(widths, chances, most_radius, sqrt(z * z + x * x));
    let is_inside: bool = x * x + y * y + z * z <= most_radius * most_radius;
    return select(0.0, along_z + along_x + along_y, is_inside);
}

// Step 3. A hit's weight for one channel: the profile at the TRUE distance |x_i - x_o|, over the density. Times the light
// that enters at x_i, it is the light that leaves at x_o. The profile ends at most_radius and keeps its energy.
fn probe_weight(surface_albedo: f32, d: f32, most_radius: f32, distance: f32, density: f32) -> f32 {
    return bounded_ratio(burley_eval(surface_albedo, distance, d), density * burley_cdf(most_radius, d));
}
