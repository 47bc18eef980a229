//! Enumerations with their texts as rows of one table.

/// The values that rows begin with, in their order.
pub const fn values<T: Copy, const N: usize, const TEXTS: usize>(
    rows: &[(T, [&'static str; TEXTS]); N],
) -> [T; N] {
    let mut values = [rows[0].0; N];
    let mut i = 1;
    while i < N {
        values[i] = rows[i].0;
        i += 1;
    }
    values
}
