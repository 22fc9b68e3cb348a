//! Images of radiance or intensity.

use raywright_optics::Rgb;

/// An image of linear colors, row by row from its top.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    width: usize,
    texels: Vec<[f32; 3]>,
}

impl Picture {
    /// Creates an image with `width` colors per row.
    ///
    /// # Errors
    /// A short reason if there are no texels, not a whole number of rows, or a value is negative or not finite.
    pub fn new(width: usize, texels: Vec<[f32; 3]>) -> Result<Self, String> {
        if width == 0 || texels.is_empty() || !texels.len().is_multiple_of(width) {
            return Err(format!("a picture must have at least one row of {width} points, got {} points", texels.len()));
        }
        match texels.iter().position(|texel| texel.iter().any(|x| !(x.is_finite() && *x >= 0.0))) {
            Some(i) => {
                let (row, column) = (i / width, i % width);
                Err(format!(
                    "a picture must be finite and at least 0, got {:?} in row {row}, column {column}",
                    texels[i]
                ))
            }
            None => Ok(Self { width, texels }),
        }
    }

    /// Number of colors per row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Number of rows.
    pub fn height(&self) -> usize {
        self.texels.len() / self.width
    }

    /// A texel.
    #[inline]
    pub fn at(&self, column: usize, row: usize) -> Rgb {
        let [red, green, blue] = self.texels[row * self.width + column].map(f64::from);
        Rgb::new(red, green, blue)
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(self.texels.as_slice())
    }
}
