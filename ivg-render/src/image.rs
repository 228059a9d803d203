use glam::Vec3;

/// A picture in linear light.
#[derive(Debug, Clone, PartialEq)]
pub struct Image {
    width: u32,
    height: u32,
    pixels: Vec<Vec3>,
}

impl Image {
    /// A picture of `width * height` pixels, row by row from the top, linear RGB with Rec. 709 primaries
    /// \[W/(m² sr)\].
    ///
    /// # Panics
    ///
    /// If `pixels` does not hold exactly `width * height` values.
    #[must_use]
    pub fn new(width: u32, height: u32, pixels: Vec<Vec3>) -> Self {
        assert_eq!(pixels.len(), width as usize * height as usize, "an image of {width} x {height} pixels");
        Self { width, height, pixels }
    }

    /// Width \[pixels\].
    #[must_use]
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height \[pixels\].
    #[must_use]
    pub fn height(&self) -> u32 {
        self.height
    }

    /// All pixels, row by row from the top \[W/(m² sr)\].
    #[must_use]
    pub fn pixels(&self) -> &[Vec3] {
        &self.pixels
    }

    /// The pixel in column `x` and row `y`, counted from the upper left corner.
    ///
    /// # Panics
    ///
    /// If the pixel lies outside the picture.
    #[must_use]
    pub fn pixel(&self, x: u32, y: u32) -> Vec3 {
        assert!(x < self.width && y < self.height, "pixel ({x}, {y}) of {} x {}", self.width, self.height);
        self.pixels[y as usize * self.width as usize + x as usize]
    }

    /// The mean of each square of `factor * factor` pixels: the last step of supersampling.
    ///
    /// # Panics
    ///
    /// If `factor` is zero or does not divide width and height.
    #[must_use]
    pub(crate) fn reduced(self, factor: u32) -> Self {
        assert!(factor > 0 && self.width.is_multiple_of(factor) && self.height.is_multiple_of(factor));
        if factor == 1 {
            return self;
        }
        let (width, height) = (self.width / factor, self.height / factor);
        let mut pixels = Vec::with_capacity(width as usize * height as usize);
        for y in 0..height {
            for x in 0..width {
                let mut sum = Vec3::ZERO;
                for sub_y in 0..factor {
                    let row = (y * factor + sub_y) as usize * self.width as usize;
                    let start = row + (x * factor) as usize;
                    for pixel in &self.pixels[start..start + factor as usize] {
                        sum += *pixel;
                    }
                }
                pixels.push(sum / (factor * factor) as f32);
            }
        }
        Self { width, height, pixels }
    }
}

/// A picture as a display or a PNG file takes it: 8 bits a channel, sRGB transfer curve.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DisplayImage {
    width: u32,
    height: u32,
    pixels: Vec<[u8; 3]>,
}

impl DisplayImage {
    /// A picture of `width * height` pixels, row by row from the top, sRGB.
    ///
    /// # Panics
    ///
    /// If `pixels` does not hold exactly `width * height` values.
    #[must_use]
    pub fn new(width: u32, height: u32, pixels: Vec<[u8; 3]>) -> Self {
        assert_eq!(pixels.len(), width as usize * height as usize, "an image of {width} x {height} pixels");
        Self { width, height, pixels }
    }

    /// Width \[pixels\].
    #[must_use]
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height \[pixels\].
    #[must_use]
    pub fn height(&self) -> u32 {
        self.height
    }

    /// All pixels, row by row from the top, red, green, blue.
    #[must_use]
    pub fn pixels(&self) -> &[[u8; 3]] {
        &self.pixels
    }
}
