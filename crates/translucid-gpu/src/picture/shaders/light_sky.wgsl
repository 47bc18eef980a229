// Light from infinity in all directions: one color, or a latitude–longitude image.
//
// The radiance of an image is interpolated bilinearly between pixel centers. A row of cells is drawn in proportion to the light
// in it, then a cell of the row, then a direction uniform in solid angle within the cell: the density is constant in a cell.
// Unlike those of the processor the tables know nothing of the normal.

struct MapPlace {
    // Image coordinates in [0, 1], v downward.
    u: f32,
    v: f32,
}

// Where the tables of an image begin.
fn map_tables(at: u32) -> u32 {
    return lights_at + u32(tables[at + 5u]);
}

fn map_number(map: u32, place: u32) -> u32 {
    return u32(tables[map + place]);
}

// A direction of the world in the environment's frame.
fn map_direction(map: u32, direction: vec3f) -> vec3f {
    return vec3f(
        dot(table_vector(map + 6u), direction),
        dot(table_vector(map + 9u), direction),
        dot(table_vector(map + 12u), direction),
    );
}

// As seen from inside with +y up: the middle is −z, right of it +x.
fn map_place(local: vec3f) -> MapPlace {
    // By both coordinates: the arc cosine alone has no digits near the poles
    let across = length(local.xz);
    return MapPlace(0.5 + turns_of(local.x, -local.z), 2.0 * turns_of(across, local.y));
}

fn sky_radiance(at: u32, direction: vec3f) -> vec3f {
    if (light_kind(at) == LIGHT_SKY) {
        return light_radiance(at);
    }
    let map = map_tables(at);
    let place = map_place(map_direction(map, direction));
    let size = vec2f(tables[map], tables[map + 1u]);
    var x = place.u * size.x - 0.5;
    x = select(x, x + size.x, x < 0.0);
    let y = clamp(place.v * size.y - 0.5, 0.0, size.y - 1.0);
    let width = u32(size.x);
    let i = min(u32(x), width - 1u);
    let j = min(u32(y), u32(size.y) - 1u);
    let right = select(i + 1u, 0u, i + 1u >= width);
    let below = min(j + 1u, u32(size.y) - 1u);
    let share = vec2f(x - f32(i), y - f32(j));
    let texels = map_number(map, 21u);
    let upper = mix(map_texel(texels, j * width + i), map_texel(texels, j * width + right), share.x);
    let lower = mix(map_texel(texels, below * width + i), map_texel(texels, below * width + right), share.x);
    return mix(upper, lower, share.y);
}

fn map_texel(texels: u32, number: u32) -> vec3f {
    let at = texels + 3u * number;
    return vec3f(bitcast<f32>(images[at]), bitcast<f32>(images[at + 1u]), bitcast<f32>(images[at + 2u]));
}

// The irradiance, of an image an estimate from six exact ones; 0 only if all of the hemisphere is black.
fn sky_importance(at: u32, receiver: Receiver) -> f32 {
    if (light_kind(at) == LIGHT_SKY) {
        return PI * luminance(light_radiance(at));
    }
    let map = map_tables(at);
    let positive = vec3f(tables[map + 15u], tables[map + 17u], tables[map + 19u]);
    let negative = vec3f(tables[map + 16u], tables[map + 18u], tables[map + 20u]);
    if (!receiver_has_normal(receiver)) {
        let greatest = max(positive, negative);
        return max(max(greatest.x, greatest.y), greatest.z);
    }
    let local = map_direction(map, receiver.normal);
    return dot(local * local, select(positive, negative, local < vec3f(0.0)));
}

// One color is drawn with the cosine if there is a normal: that leaves no noise on a matte surface.
fn sky_direction(at: u32, normal: vec3f, u: vec2f) -> vec3f {
    if (light_kind(at) == LIGHT_SKY) {
        if (!is_zero_vector(normal)) {
            return cosine_hemisphere(normal, u);
        }
        return uniform_sphere(u);
    }
    let map = map_tables(at);
    let hash = light_hash(0.0, u);
    let rows = map_number(map, 3u);
    let row_table = map_number(map, 22u);
    let row_word = light_word(u.x, hash);
    let row = table_index(row_table, rows, row_word);
    let columns = map_number(map, 2u);
    let column_table = map_column_table(map, row);
    let column_word = light_word(u.y, hash >> 8u);
    let column = table_index(column_table, columns, column_word);

    // sin² and cos² of half the polar angle have digits at either pole
    let edge = map + MAP_HEADER + 2u * row;
    let share = table_rest(row_table, row, row_word);
    let halves = mix(vec2f(tables[edge], tables[edge + 1u]), vec2f(tables[edge + 2u], tables[edge + 3u]), share);
    let sine = 2.0 * sqrt(halves.x * halves.y);
    let left = map_column_edge(map, column);
    let turns = left + table_rest(column_table, column, column_word) * (map_column_edge(map, column + 1u) - left);
    // The image's middle is half a turn from where the circle begins
    let circle = -circle(turns);
    let local = vec3f(sine * circle.y, halves.y - halves.x, -sine * circle.x);
    let world = table_vector(map + 6u) * local.x + table_vector(map + 9u) * local.y + table_vector(map + 12u) * local.z;
    return normalize(world);
}

// Where the table of a row's cells begins.
fn map_column_table(map: u32, row: u32) -> u32 {
    return map_number(map, 23u) + row * (map_number(map, 2u) + 1u);
}

// Image coordinate of the left edge of a column of cells.
fn map_column_edge(map: u32, column: u32) -> f32 {
    return min(f32(column) * tables[map + 4u], tables[map]) / tables[map];
}

fn sky_pdf(at: u32, normal: vec3f, direction: vec3f) -> f32 {
    if (light_kind(at) == LIGHT_SKY) {
        return select(max(dot(normal, direction), 0.0) / PI, 0.25 / PI, is_zero_vector(normal));
    }
    let map = map_tables(at);
    let place = map_place(map_direction(map, direction));
    let pixel = vec2u(
        min(u32(place.u * tables[map]), map_number(map, 0u) - 1u),
        min(u32(place.v * tables[map + 1u]), map_number(map, 1u) - 1u),
    );
    let column = pixel.x / map_number(map, 4u);
    let row = pixel.y / map_number(map, 5u);
    let of_row = table_probability(map_number(map, 22u), row);
    let of_cell = table_probability(map_column_table(map, row), column);
    // Solid angle of the whole row, and the cell's share of it
    let around = tables[map + MAP_HEADER + 2u * (map_number(map, 3u) + 1u) + row];
    let width = map_column_edge(map, column + 1u) - map_column_edge(map, column);
    return of_row * of_cell / (around * width);
}
