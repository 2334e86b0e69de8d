//! Interpolation of a function of two arguments on a grid.
//!
//! Smooth interpolation uses bicubic Hermite polynomials with the partial derivatives of H. Akima,
//! "A method of bivariate interpolation and smooth surface fitting based on local procedures",
//! Comm. ACM 17 (1974) 18-20.

use super::curve::wrapped;
use super::{Extrapolation, interval};
use crate::base::wire::wire_struct;
use crate::numeric::hermite::{Smoothness, extended, hermite, weights};

/// A piecewise polynomial of two arguments, with its derivatives.
#[derive(Clone, PartialEq, Debug)]
pub struct Surface {
    x: Vec<f64>,
    y: Vec<f64>,
    /// For each cell of the grid, row by row, the coefficients of `dx^i dy^j`, row by row.
    cells: Vec<[f64; 16]>,
    /// The coefficients for extrapolation if they differ: piecewise constant surfaces are
    /// extrapolated linearly.
    beyond: Option<Vec<[f64; 16]>>,
    /// Directions with a single point, along which the function is constant.
    level: [bool; 2],
    extrapolation: Extrapolation,
}

impl Surface {
    /// Interpolates values `z` on the grid `x` times `y`, row by row. `None` if there are no
    /// points, if the abscissae do not increase, if a number is not finite, or for a smoothness
    /// other than linear, Akima and constant.
    pub fn new(
        x: &[f64],
        y: &[f64],
        z: &[f64],
        smoothness: Smoothness,
        extrapolation: Extrapolation,
    ) -> Option<Surface> {
        let (m, n) = (x.len(), y.len());
        let numbers = x.iter().chain(y).chain(z);
        if m == 0 || n == 0 || z.len() != m * n || numbers.into_iter().any(|v| !v.is_finite()) {
            return None;
        }
        if x.windows(2).chain(y.windows(2)).any(|p| p[0] >= p[1]) {
            return None;
        }
        // A single row or column is duplicated.
        if m == 1 {
            let twice = [z, z].concat();
            let x = [x[0], x[0] + 1.0];
            let surface = Self::new(&x, y, &twice, smoothness, extrapolation)?;
            return Some(Surface { level: [true, surface.level[1]], ..surface });
        }
        if n == 1 {
            let twice: Vec<f64> = z.iter().flat_map(|v| [*v, *v]).collect();
            let y = [y[0], y[0] + 1.0];
            let surface = Self::new(x, &y, &twice, smoothness, extrapolation)?;
            return Some(Surface { level: [surface.level[0], true], ..surface });
        }
        let grid = Grid { x, y, z };
        let cells = match smoothness {
            Smoothness::Constant => grid.each(|i, j| {
                let mut c = [0.0; 16];
                c[0] = grid.z(i, j);
                c
            }),
            Smoothness::Linear => grid.each(|i, j| grid.bilinear(i, j)),
            Smoothness::Akima => {
                let partials = grid.partials(extrapolation == Extrapolation::Periodic);
                grid.each(|i, j| grid.bicubic(i, j, &partials))
            }
            _ => return None,
        };
        let steps = smoothness == Smoothness::Constant && extrapolation == Extrapolation::Linear;
        let beyond = steps.then(|| grid.each(|i, j| grid.bilinear(i, j)));
        Some(Surface {
            x: x.to_vec(),
            y: y.to_vec(),
            cells,
            beyond,
            level: [false; 2],
            extrapolation,
        })
    }

    /// The ranges of the first and the second argument.
    pub fn range(&self) -> [(f64, f64); 2] {
        [&self.x, &self.y].map(|a| (a[0], a[a.len() - 1]))
    }

    /// Extrapolation beyond the grid.
    pub fn extrapolation(&self) -> Extrapolation {
        self.extrapolation
    }

    /// The partial derivative of these orders at `(u, v)`; the value for orders 0.
    pub fn at(&self, u: f64, v: f64, orders: (u8, u8)) -> f64 {
        let [x, y] = self.range();
        let (u, du) = self.clamped(u, x);
        let (v, dv) = self.clamped(v, y);
        let (i, j) = (interval(&self.x, u), interval(&self.y, v));
        let cells = match &self.beyond {
            Some(beyond) if du.is_some() && !self.level[0] || dv.is_some() && !self.level[1] => {
                beyond
            }
            _ => &self.cells,
        };
        let cell = &cells[i * (self.y.len() - 1) + j];
        let (p, q) = (u - self.x[i], v - self.y[j]);
        // Beyond the grid, extrapolate by the tangent or the value in each direction.
        let along = |order: u8, beyond: Option<f64>| -> [(u8, f64); 2] {
            match beyond {
                None => [(order, 1.0), (order, 0.0)],
                Some(_) if self.extrapolation != Extrapolation::Linear => {
                    [(0, if order == 0 { 1.0 } else { 0.0 }), (0, 0.0)]
                }
                Some(d) => match order {
                    0 => [(0, 1.0), (1, d)],
                    1 => [(1, 1.0), (1, 0.0)],
                    _ => [(0, 0.0), (0, 0.0)],
                },
            }
        };
        let mut sum = 0.0;
        for (k, a) in along(orders.0, du) {
            for (l, b) in along(orders.1, dv) {
                if a * b != 0.0 {
                    sum += a * b * bipolynomial(cell, p, q, k, l);
                }
            }
        }
        sum
    }

    /// An argument clamped to the range, and its distance from the range.
    fn clamped(&self, u: f64, (first, last): (f64, f64)) -> (f64, Option<f64>) {
        match self.extrapolation {
            Extrapolation::Periodic => (wrapped(u, first, last), None),
            _ if u < first => (first, Some(u - first)),
            _ if u > last => (last, Some(u - last)),
            _ => (u, None),
        }
    }
}

struct Grid<'a> {
    x: &'a [f64],
    y: &'a [f64],
    z: &'a [f64],
}

/// `dz/dx`, `dz/dy` and `d2z/dxdy` at the points of a grid, row by row.
struct Partials {
    by_x: Vec<f64>,
    by_y: Vec<f64>,
    by_both: Vec<f64>,
}

impl Grid<'_> {
    fn z(&self, i: usize, j: usize) -> f64 {
        self.z[i * self.y.len() + j]
    }

    fn each(&self, cell: impl Fn(usize, usize) -> [f64; 16]) -> Vec<[f64; 16]> {
        let (rows, columns) = (self.x.len() - 1, self.y.len() - 1);
        (0..rows * columns).map(|k| cell(k / columns, k % columns)).collect()
    }

    fn bilinear(&self, i: usize, j: usize) -> [f64; 16] {
        let (hx, hy) = (self.x[i + 1] - self.x[i], self.y[j + 1] - self.y[j]);
        let [a, b, c, d] = [self.z(i, j), self.z(i, j + 1), self.z(i + 1, j), self.z(i + 1, j + 1)];
        let mut cell = [0.0; 16];
        cell[0] = a;
        cell[1] = (b - a) / hy;
        cell[4] = (c - a) / hx;
        cell[5] = (a + d - b - c) / (hx * hy);
        cell
    }

    /// Hermite interpolation in `y` on both sides of the cell, for values and `x` slopes, then in
    /// `x`.
    fn bicubic(&self, i: usize, j: usize, p: &Partials) -> [f64; 16] {
        let (hx, hy) = (self.x[i + 1] - self.x[i], self.y[j + 1] - self.y[j]);
        let at = |i: usize, j: usize| i * self.y.len() + j;
        let side = |i: usize, value: &[f64], slope: &[f64]| {
            let (a, b) = (at(i, j), at(i, j + 1));
            hermite(hy, value[a], value[b], slope[a], slope[b])
        };
        let (z0, z1) = (side(i, self.z, &p.by_y), side(i + 1, self.z, &p.by_y));
        let (s0, s1) = (side(i, &p.by_x, &p.by_both), side(i + 1, &p.by_x, &p.by_both));
        let mut cell = [0.0; 16];
        for l in 0..4 {
            for (k, c) in hermite(hx, z0[l], z1[l], s0[l], s1[l]).into_iter().enumerate() {
                cell[4 * k + l] = c;
            }
        }
        cell
    }

    fn partials(&self, periodic: bool) -> Partials {
        let (m, n) = (self.x.len(), self.y.len());
        let row = |i: usize| -> Vec<f64> { self.z[i * n..(i + 1) * n].to_vec() };
        let column = |j: usize| -> Vec<f64> { (0..m).map(|i| self.z(i, j)).collect() };
        // Secants with two more on each side, along y for each row and along x for each column.
        let along_y: Vec<Vec<f64>> =
            (0..m).map(|i| extended(&secants(self.y, &row(i)), periodic)).collect();
        let along_x: Vec<Vec<f64>> =
            (0..n).map(|j| extended(&secants(self.x, &column(j)), periodic)).collect();
        // Secants along x of secants along y, with one more on each side, by column of `along_y`.
        let crossed: Vec<Vec<f64>> = (0..n + 3)
            .map(|l| {
                let column: Vec<f64> = along_y.iter().map(|row| row[l]).collect();
                extended(&secants(self.x, &column), periodic)
            })
            .collect();
        let mut p = Partials { by_x: vec![], by_y: vec![], by_both: vec![] };
        for i in 0..m {
            for j in 0..n {
                let (dx, dy) = (&along_x[j][i..i + 4], &along_y[i][j..j + 4]);
                let ((xl, xr), (yl, yr)) = (weights(dx, false), weights(dy, false));
                p.by_x.push(xl * dx[1] + xr * dx[2]);
                p.by_y.push(yl * dy[1] + yr * dy[2]);
                let (before, after) = (&crossed[j + 1], &crossed[j + 2]);
                p.by_both.push(
                    xl * (yl * before[i + 1] + yr * after[i + 1])
                        + xr * (yl * before[i + 2] + yr * after[i + 2]),
                );
            }
        }
        p
    }
}

fn secants(x: &[f64], y: &[f64]) -> Vec<f64> {
    (1..x.len()).map(|i| (y[i] - y[i - 1]) / (x[i] - x[i - 1])).collect()
}

/// The derivative of orders `k` and `l` of a polynomial of degree 3 in each argument.
fn bipolynomial(c: &[f64; 16], p: f64, q: f64, k: u8, l: u8) -> f64 {
    // i (i-1) ... (i-k+1), with p^(i-k)
    let factor = |i: usize, k: usize, p: f64| -> f64 {
        if i < k {
            return 0.0;
        }
        let falling: f64 = (0..k).map(|d| (i - d) as f64).product();
        falling * p.powi((i - k) as i32)
    };
    let mut sum = 0.0;
    for i in 0..4 {
        for j in 0..4 {
            let a = c[4 * i + j];
            if a != 0.0 {
                sum += a * factor(i, k as usize, p) * factor(j, l as usize, q);
            }
        }
    }
    sum
}

wire_struct!(Surface { x, y, cells, beyond, level, extrapolation });

#[cfg(test)]
mod tests {
    use super::*;

    const X: [f64; 4] = [0.0, 1.0, 2.5, 3.0];
    const Y: [f64; 5] = [-1.0, 0.0, 1.0, 2.0, 4.0];

    fn sampled(f: impl Fn(f64, f64) -> f64, s: Smoothness, e: Extrapolation) -> Surface {
        let z: Vec<f64> = X.iter().flat_map(|x| Y.map(|y| f(*x, y))).collect();
        Surface::new(&X, &Y, &z, s, e).unwrap()
    }

    #[test]
    fn a_bilinear_function_is_reproduced() {
        let f = |x: f64, y: f64| (1.0 + 2.0 * x) * (3.0 - y);
        for s in [Smoothness::Linear, Smoothness::Akima] {
            let surface = sampled(f, s, Extrapolation::Linear);
            for (u, v) in [(0.3, 0.2), (2.7, 3.1), (-1.0, 0.5), (4.0, 6.0), (1.0, -3.0)] {
                let found = surface.at(u, v, (0, 0));
                assert!((found - f(u, v)).abs() < 1e-12, "{s:?} at {u}, {v}: {found}");
            }
        }
    }

    /// A piecewise constant surface is extrapolated linearly. One column is equivalent to two equal
    /// ones.
    #[test]
    fn steps_are_extrapolated_linearly() {
        let x = [2.0, 3.0, 4.0];
        let steps = |y: &[f64], z: &[f64]| {
            Surface::new(&x, y, z, Smoothness::Constant, Extrapolation::Linear).unwrap()
        };
        let wide = steps(&[0.0, 6.0], &[4.0, 4.0, 9.0, 9.0, 16.0, 16.0]);
        let narrow = steps(&[1.0], &[4.0, 9.0, 16.0]);
        for (u, expected) in [(0.0, -6.0), (1.9, 3.5), (2.5, 4.0), (3.5, 9.0), (5.0, 23.0)] {
            assert!((wide.at(u, 3.0, (0, 0)) - expected).abs() < 1e-12, "{u}");
            assert!((narrow.at(u, u, (0, 0)) - expected).abs() < 1e-12, "{u}");
        }
    }

    #[test]
    fn a_function_of_one_argument_is_the_curve() {
        use super::super::curve::Curve;
        let f = |x: f64| x * x * x - 2.0 * x;
        let curve = Curve::new(&X, &X.map(f), Smoothness::Akima, Extrapolation::Hold).unwrap();
        let surface = sampled(|x, _| f(x), Smoothness::Akima, Extrapolation::Hold);
        for u in [0.1, 0.9, 1.7, 2.8] {
            assert!((surface.at(u, 0.7, (0, 0)) - curve.at(u, 0)).abs() < 1e-12);
            assert!((surface.at(u, 0.7, (1, 0)) - curve.at(u, 1)).abs() < 1e-12);
            assert!(surface.at(u, 0.7, (0, 1)).abs() < 1e-12);
        }
    }

    #[test]
    fn derivatives_agree_with_differences() {
        let f = |x: f64, y: f64| (x - y).sin() + x * y * y;
        let h = 1e-6;
        for s in [Smoothness::Linear, Smoothness::Akima] {
            for e in [Extrapolation::Hold, Extrapolation::Linear, Extrapolation::Periodic] {
                let surface = sampled(f, s, e);
                for (u, v) in [(0.3, 0.2), (2.7, 3.1), (-0.4, 0.5), (3.4, 4.6)] {
                    let value = |u, v| surface.at(u, v, (0, 0));
                    let by_u = (value(u + h, v) - value(u - h, v)) / (2.0 * h);
                    let by_v = (value(u, v + h) - value(u, v - h)) / (2.0 * h);
                    assert!((by_u - surface.at(u, v, (1, 0))).abs() < 1e-7, "{s:?} {e:?}");
                    assert!((by_v - surface.at(u, v, (0, 1))).abs() < 1e-7, "{s:?} {e:?}");
                }
            }
        }
    }
}
