//! The contact sheet: the four pictures side by side with their captions.

use std::path::Path;

use font8x8::UnicodeFonts;
use ivg_render::DisplayImage;

use super::Shot;
use crate::failure::Failure;
use crate::files;

/// Space around pictures \[pixels\].
const MARGIN: u32 = 8;
/// Side of a character \[pixels\].
const CHARACTER: u32 = 8;
const BACKGROUND: [u8; 3] = [24, 24, 24];
const TEXT: [u8; 3] = [224, 224, 224];

/// Writes the pictures in two rows of two, shown with `exposure`.
pub(super) fn write(path: &Path, shots: &[Shot], exposure: f32) -> Result<(), Failure> {
    let pictures: Vec<DisplayImage> =
        shots.iter().map(|shot| ivg_render::tonemap(&shot.image, exposure)).collect();
    let (width, height) = pictures.first().map_or((0, 0), |picture| (picture.width(), picture.height()));
    let cell = (width + MARGIN, height + CHARACTER + 3 * MARGIN);
    let columns = 2.min(shots.len() as u32);
    let rows = (shots.len() as u32).div_ceil(2);
    let mut sheet = Sheet::new(MARGIN + columns * cell.0, MARGIN + rows * cell.1);
    for (number, (shot, picture)) in shots.iter().zip(&pictures).enumerate() {
        let (column, row) = (number as u32 % 2, number as u32 / 2);
        let (left, top) = (MARGIN + column * cell.0, MARGIN + row * cell.1);
        sheet.picture(left, top, picture);
        sheet.text(left, top + height + MARGIN, left + width, shot.stage.caption);
    }
    let bytes = ivg_render::png::encode(&sheet.finish()).map_err(|error| Failure::file(path, error))?;
    files::write(path, &bytes)
}

struct Sheet {
    width: u32,
    height: u32,
    pixels: Vec<[u8; 3]>,
}

impl Sheet {
    fn new(width: u32, height: u32) -> Self {
        Self { width, height, pixels: vec![BACKGROUND; (width * height) as usize] }
    }

    fn set(&mut self, x: u32, y: u32, colour: [u8; 3]) {
        if x < self.width && y < self.height {
            self.pixels[(y * self.width + x) as usize] = colour;
        }
    }

    fn picture(&mut self, left: u32, top: u32, picture: &DisplayImage) {
        for y in 0..picture.height() {
            for x in 0..picture.width() {
                self.set(left + x, top + y, picture.pixels()[(y * picture.width() + x) as usize]);
            }
        }
    }

    /// Draws one line of text that ends at `right`, if need be in the middle of a word.
    fn text(&mut self, left: u32, top: u32, right: u32, text: &str) {
        for (place, character) in (0..).zip(text.chars()) {
            let glyph_left = left + place * CHARACTER;
            if glyph_left + CHARACTER > right {
                return;
            }
            for (row, bits) in (0..).zip(font8x8::BASIC_FONTS.get(character).unwrap_or_default()) {
                for column in (0..CHARACTER).filter(|column| bits >> column & 1 == 1) {
                    self.set(glyph_left + column, top + row, TEXT);
                }
            }
        }
    }

    fn finish(self) -> DisplayImage {
        DisplayImage::new(self.width, self.height, self.pixels)
    }
}
