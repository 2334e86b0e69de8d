//! Solutions with many right-hand sides at once: panels ([`crate::numeric::panel`]).

use crate::integrate::matrix::{IterationMatrix, Parts};

/// Working memory, allocated at the first panel.
#[derive(Default)]
pub(super) struct PanelMemory {
    /// Rows of the substituted unknowns, while the core is solved.
    solved_re: Vec<f64>,
    solved_im: Vec<f64>,
    core_re: Vec<f64>,
    core_im: Vec<f64>,
}

impl PanelMemory {
    fn reserve(&mut self, n: usize, width: usize) {
        let length = n * width;
        if self.core_re.len() < length {
            for plane in
                [&mut self.solved_re, &mut self.solved_im, &mut self.core_re, &mut self.core_im]
            {
                plane.resize(length, 0.0);
            }
        }
    }
}

impl IterationMatrix {
    /// Solves with both matrices, in place, for all columns of panels: `a` with the real one, `re + i im` with the
    /// complex one.
    pub fn solve_panels(&mut self, [a, re, im]: &mut [Vec<f64>; 3], width: usize) {
        let Some(elimination) = self.elimination.as_mut().filter(|_| self.is_eliminated) else {
            self.solve_real_panel(a, width);
            return self.solve_complex_panel(re, im, width);
        };
        (0..width).for_each(|column| elimination.solve_column(a, re, im, (width, column)));
    }

    /// Solves with the real matrix, in place, for all columns of a panel.
    fn solve_real_panel(&mut self, b: &mut [f64], width: usize) {
        let IterationMatrix { split, parts, panel, .. } = self;
        if split.substituted.is_empty() {
            return parts.solve_real_panel(b, self.mass.len(), width, &mut self.core_re);
        }
        panel.reserve(self.mass.len(), width);
        let mut start = 0;
        for (k, s) in split.substituted.iter().enumerate() {
            let x = &mut panel.solved_re[k * width..(k + 1) * width];
            for (x, b) in x.iter_mut().zip(row(b, s.row, width)) {
                *x = b * self.pivots[k];
            }
            for c in &split.couplings[start..s.end] {
                let factor = c.mass * self.shift.real - c.jacobian;
                for (b, x) in row_mut(b, c.row, width).iter_mut().zip(x.iter()) {
                    *b -= factor * x;
                }
            }
            start = s.end;
        }
        let order = split.rows.len();
        let core = &mut panel.core_re[..order * width];
        gather(&split.rows, b, core, width);
        parts.solve_real_panel(core, order, width, &mut self.core_re);
        scatter(&split.columns, core, b, width);
        for (k, s) in split.substituted.iter().enumerate() {
            row_mut(b, s.column, width).copy_from_slice(row(&panel.solved_re, k, width));
        }
    }

    /// Solves with the complex matrix, in place, for all columns of a panel.
    fn solve_complex_panel(&mut self, b_re: &mut [f64], b_im: &mut [f64], width: usize) {
        let IterationMatrix { split, parts, panel, core_re, core_im, .. } = self;
        let scratch = (&mut core_re[..], &mut core_im[..]);
        if split.substituted.is_empty() {
            return parts.solve_complex_panel((b_re, b_im), self.mass.len(), width, scratch);
        }
        panel.reserve(self.mass.len(), width);
        let mut start = 0;
        for (k, s) in split.substituted.iter().enumerate() {
            let (p, q) = (self.pivots_re[k], self.pivots_im[k]);
            let range = k * width..(k + 1) * width;
            let (x, y) = (&mut panel.solved_re[range.clone()], &mut panel.solved_im[range]);
            let right = row(b_re, s.row, width).iter().zip(row(b_im, s.row, width));
            for ((x, y), (r, i)) in x.iter_mut().zip(y.iter_mut()).zip(right) {
                (*x, *y) = (r * p - i * q, r * q + i * p);
            }
            for c in &split.couplings[start..s.end] {
                let (re, im) = (c.mass * self.shift.re - c.jacobian, c.mass * self.shift.im);
                let planes = (row_mut(b_re, c.row, width).iter_mut())
                    .zip(row_mut(b_im, c.row, width).iter_mut());
                for ((r, i), (x, y)) in planes.zip(x.iter().zip(y.iter())) {
                    *r -= re * x - im * y;
                    *i -= re * y + im * x;
                }
            }
            start = s.end;
        }
        let order = split.rows.len();
        let core = (&mut panel.core_re[..order * width], &mut panel.core_im[..order * width]);
        gather(&split.rows, b_re, core.0, width);
        gather(&split.rows, b_im, core.1, width);
        parts.solve_complex_panel((&mut *core.0, &mut *core.1), order, width, scratch);
        scatter(&split.columns, core.0, b_re, width);
        scatter(&split.columns, core.1, b_im, width);
        for (k, s) in split.substituted.iter().enumerate() {
            row_mut(b_re, s.column, width).copy_from_slice(row(&panel.solved_re, k, width));
            row_mut(b_im, s.column, width).copy_from_slice(row(&panel.solved_im, k, width));
        }
    }
}

impl Parts {
    /// Solves with the core of the real matrix, of the given order; column by column where that is large.
    fn solve_real_panel(&mut self, b: &mut [f64], order: usize, width: usize, column: &mut [f64]) {
        if let Parts::Dense(parts) = self
            && parts.real.solve_panel(b, width)
        {
            return;
        }
        let column = &mut column[..order];
        for d in 0..width {
            (0..order).for_each(|i| column[i] = b[i * width + d]);
            self.solve_real(column);
            (0..order).for_each(|i| b[i * width + d] = column[i]);
        }
    }

    /// The same with the complex matrix.
    fn solve_complex_panel(
        &mut self,
        (b_re, b_im): (&mut [f64], &mut [f64]),
        order: usize,
        width: usize,
        (re, im): (&mut [f64], &mut [f64]),
    ) {
        if let Parts::Dense(parts) = self
            && let Some(complex) = &parts.complex
            && complex.solve_panel(b_re, b_im, width)
        {
            return;
        }
        let (re, im) = (&mut re[..order], &mut im[..order]);
        for d in 0..width {
            (0..order).for_each(|i| (re[i], im[i]) = (b_re[i * width + d], b_im[i * width + d]));
            self.solve_complex(re, im);
            (0..order).for_each(|i| (b_re[i * width + d], b_im[i * width + d]) = (re[i], im[i]));
        }
    }
}

fn row(panel: &[f64], i: usize, width: usize) -> &[f64] {
    &panel[i * width..(i + 1) * width]
}

fn row_mut(panel: &mut [f64], i: usize, width: usize) -> &mut [f64] {
    &mut panel[i * width..(i + 1) * width]
}

fn gather(indices: &[usize], from: &[f64], to: &mut [f64], width: usize) {
    for (to, &i) in to.chunks_exact_mut(width).zip(indices) {
        to.copy_from_slice(row(from, i, width));
    }
}

fn scatter(indices: &[usize], from: &[f64], to: &mut [f64], width: usize) {
    for (from, &i) in from.chunks_exact(width).zip(indices) {
        row_mut(to, i, width).copy_from_slice(from);
    }
}
