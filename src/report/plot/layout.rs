//! Layout of a plot; lengths in px from the upper left corner.

/// Labels of a panel that determine its layout.
#[derive(Clone, PartialEq, Debug)]
pub struct PanelText {
    /// The label of the vertical axis.
    pub axis: String,
    /// The names of the curves.
    pub legend: Vec<String>,
    /// The panel needs little height, such as one of Booleans.
    pub low: bool,
}

/// The layout of a whole plot.
#[derive(Clone, PartialEq, Debug)]
pub struct Layout {
    /// Left end of all panels.
    pub left: f64,
    /// Right end of all panels.
    pub right: f64,
    /// Vertical middle of the title.
    pub title: f64,
    /// The panels from top to bottom.
    pub panels: Vec<PanelPlace>,
    /// Vertical middle of the numbers at the time axis.
    pub time_numbers: f64,
    /// Vertical middle of the label of the time axis.
    pub time_axis: f64,
}

/// The layout of one panel.
#[derive(Clone, PartialEq, Debug)]
pub struct PanelPlace {
    /// Upper end of the plot area.
    pub top: f64,
    /// Lower end of the plot area.
    pub bottom: f64,
    /// Vertical middle of the axis label, which starts at [`Layout::left`].
    pub axis: f64,
    /// Left end and vertical middle of each legend entry: a stroke of length [`SWATCH`], then the
    /// name.
    pub legend: Vec<(f64, f64)>,
}

/// Font size of the title.
pub const TITLE_SIZE: f64 = 17.0;
/// Font size of axis labels and legends.
pub const TEXT_SIZE: f64 = 13.0;
/// Font size of the numbers at the axes.
pub const NUMBER_SIZE: f64 = 12.5;
/// Length of the stroke in front of a legend entry.
pub const SWATCH: f64 = 18.0;
/// Distance from the end of that stroke to the name.
pub const SWATCH_GAP: f64 = 6.0;

const MARGIN: f64 = 20.0;
const TITLE_HEIGHT: f64 = 36.0;
const LINE_HEIGHT: f64 = 19.0;
const HEADER_GAP: f64 = 5.0;
const PANEL_GAP: f64 = 16.0;
const NUMBER_GAP: f64 = 8.0;
const ENTRY_GAP: f64 = 20.0;
const FOOT: f64 = 48.0;
const MIN_PANEL: f64 = 48.0;
/// Height of a low panel relative to others.
const LOW_RATIO: f64 = 0.4;

/// Divides a plot into a title (if `titled`) and panels. `numbers` is the width of the widest
/// number at a vertical axis. The error is the required height.
pub fn layout(
    (width, height): (f64, f64),
    titled: bool,
    numbers: f64,
    texts: &[PanelText],
) -> Result<Layout, f64> {
    let left = MARGIN + numbers + NUMBER_GAP;
    let right = width - MARGIN;
    let head = if titled { MARGIN / 2.0 + TITLE_HEIGHT } else { MARGIN / 2.0 };
    let headers: Vec<Header> = texts.iter().map(|t| header(t, left, right)).collect();
    let gaps = PANEL_GAP * texts.len().saturating_sub(1) as f64;
    let fixed = head + gaps + FOOT + headers.iter().map(|h| h.height).sum::<f64>();
    let shares = texts.iter().map(share).sum::<f64>();
    let unit = (height - fixed) / shares;
    if unit < MIN_PANEL {
        return Err((fixed + MIN_PANEL * shares).ceil());
    }
    let mut y = head;
    let mut panels = Vec::with_capacity(texts.len());
    for (text, header) in texts.iter().zip(headers) {
        let top = y + header.height;
        panels.push(PanelPlace {
            top,
            bottom: top + unit * share(text),
            axis: y + LINE_HEIGHT / 2.0,
            legend: header.legend.iter().map(|&(x, dy)| (x, y + dy)).collect(),
        });
        y = top + unit * share(text) + PANEL_GAP;
    }
    let foot = height - FOOT;
    Ok(Layout {
        left,
        right,
        title: MARGIN / 2.0 + TITLE_HEIGHT / 2.0 - 2.0,
        panels,
        time_numbers: foot + 14.0,
        time_axis: foot + 33.0,
    })
}

/// Width of a text in the embedded typeface; other typefaces are similar. Slightly overestimated
/// for characters outside ASCII.
pub fn text_width(text: &str, size: f64) -> f64 {
    let advance = |c: char| {
        let i = (c as usize).wrapping_sub(' ' as usize);
        ADVANCES.get(i).map_or(0.7, |&percent| f64::from(percent) / 100.0)
    };
    size * text.chars().map(advance).sum::<f64>()
}

/// Shortens a text to `room` px by omitting its middle: the end of a dotted name is more
/// informative.
pub fn shortened(text: &str, size: f64, room: f64) -> String {
    const CUT: &str = "...";
    if text_width(text, size) <= room {
        return text.to_owned();
    }
    let letters: Vec<char> = text.chars().collect();
    let (mut kept, mut best) = (0, CUT.to_owned());
    while kept < letters.len() {
        kept += 1;
        let head = kept * 2 / 5;
        let tail = letters.len() - (kept - head);
        let cut: String = letters[..head]
            .iter()
            .chain(&CUT.chars().collect::<Vec<_>>())
            .chain(&letters[tail..])
            .collect();
        if text_width(&cut, size) > room {
            break;
        }
        best = cut;
    }
    best
}

/// Advance widths of the printable ASCII characters from the space on, in percent of the font size.
#[rustfmt::skip]
const ADVANCES: [u8; 95] = [
    28, 28, 40, 63, 64, 81, 64, 22, 36, 36, 50, 66, 28, 46, 28, 36, 62, 46, 61, 64, 64, 61, 62, 57,
    62, 62, 28, 28, 66, 66, 66, 51, 94, 68, 65, 73, 72, 60, 59, 74, 74, 26, 54, 65, 56, 89, 75, 76,
    63, 76, 64, 64, 64, 74, 68, 95, 64, 66, 62, 36, 36, 36, 47, 45, 50, 56, 62, 56, 62, 58, 36, 61,
    59, 24, 24, 54, 24, 87, 59, 60, 61, 61, 37, 52, 36, 58, 56, 81, 54, 56, 54, 36, 33, 36, 66,
];

/// The header of a panel, relative to its upper end.
struct Header {
    height: f64,
    legend: Vec<(f64, f64)>,
}

/// Places the legend at the right end of the line of the axis label; if it does not fit, in a
/// separate line below, or as a table of several lines.
fn header(text: &PanelText, left: f64, right: f64) -> Header {
    let widths: Vec<f64> = text
        .legend
        .iter()
        .map(|name| SWATCH + SWATCH_GAP + text_width(name, TEXT_SIZE) + ENTRY_GAP)
        .collect();
    let axis = left + text_width(&text.axis, TEXT_SIZE) + ENTRY_GAP;
    let start = right - widths.iter().sum::<f64>() + ENTRY_GAP;
    let beside = start >= axis;
    let one_line = start >= left;
    let widest = widths.iter().copied().fold(0.0, f64::max);
    let (mut x, mut line) = if beside { (start, 0.0) } else { (left, 1.0) };
    let mut legend = Vec::with_capacity(widths.len());
    for own in widths {
        let width = if one_line { own } else { widest };
        // The first entry of a line stays there regardless of its length.
        if x > left && x + width - ENTRY_GAP > right + 1e-6 {
            (x, line) = (left, line + 1.0);
        }
        legend.push((x, (line + 0.5) * LINE_HEIGHT));
        x += width;
    }
    Header { height: (line + 1.0) * LINE_HEIGHT + HEADER_GAP, legend }
}

fn share(text: &PanelText) -> f64 {
    if text.low { LOW_RATIO } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn panel(names: &[&str], low: bool) -> PanelText {
        PanelText {
            axis: "pressure in bar".into(),
            legend: names.iter().map(|&n| n.into()).collect(),
            low,
        }
    }

    #[test]
    fn a_long_text_keeps_its_ends_and_fits() {
        assert_eq!(shortened("piston.p", TEXT_SIZE, 200.0), "piston.p");
        let long = format!("machine.{}.piston.p", "unit.".repeat(40));
        let cut = shortened(&long, TEXT_SIZE, 200.0);
        assert!(cut.starts_with("machine.") && cut.ends_with(".piston.p"), "{cut}");
        let width = text_width(&cut, TEXT_SIZE);
        assert!((170.0..=200.0).contains(&width), "{width}");
        assert_eq!(shortened(&long, TEXT_SIZE, 1.0), "...");
    }

    #[test]
    fn panels_fill_the_height_in_order() {
        let texts = [panel(&["a"], false), panel(&["b"], true), panel(&["c"], false)];
        let l = layout((800.0, 600.0), true, 30.0, &texts).unwrap();
        let ys: Vec<f64> = l
            .panels
            .iter()
            .flat_map(|p| [p.axis, p.top, p.bottom])
            .chain([l.time_numbers])
            .collect();
        assert!(ys.is_sorted() && l.title < ys[0] && l.time_axis < 600.0, "{ys:?}");
        let heights: Vec<f64> = l.panels.iter().map(|p| p.bottom - p.top).collect();
        assert!((heights[0] - heights[2]).abs() < 1e-9);
        assert!((heights[1] - 0.4 * heights[0]).abs() < 1e-9);
        assert!((l.panels[2].bottom - (600.0 - FOOT)).abs() < 1e-9);
    }

    #[test]
    fn long_legends_break_into_lines_within_the_width() {
        let names: Vec<String> = (0..30).map(|i| format!("machine.piston[{i}].p")).collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let l = layout((800.0, 600.0), false, 30.0, &[panel(&names, false)]).unwrap();
        let p = &l.panels[0];
        for (&(x, y), name) in p.legend.iter().zip(&names) {
            let end = x + SWATCH + SWATCH_GAP + text_width(name, TEXT_SIZE);
            assert!(x >= l.left && end <= l.right && y > p.axis && y < p.top, "{name}");
        }
        let short = layout((800.0, 600.0), false, 30.0, &[panel(&["p"], false)]).unwrap();
        assert_eq!(short.panels[0].legend[0].1, short.panels[0].axis);
    }

    #[test]
    fn too_little_height_names_enough() {
        let texts = vec![panel(&["a"], false); 9];
        let enough = layout((800.0, 300.0), true, 30.0, &texts).unwrap_err();
        assert!(enough > 300.0);
        assert!(layout((800.0, enough), true, 30.0, &texts).is_ok());
    }
}
