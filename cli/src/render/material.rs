//! Colours and shine of skin, eyes, teeth, tongue and lashes. All colours are linear RGB.

use glam::Vec3;

use super::figure::Material;
use super::light::Studio;
use super::raster::Varying;

/// What a fragment needs besides its own attributes.
pub(crate) struct Shading<'a> {
    pub(crate) studio: &'a Studio,
    /// The camera's place in view space.
    pub(crate) eye: Vec3,
    /// The figure's own +Z in view space: where its eyes look.
    pub(crate) forward: Vec3,
    /// Albedo of the skin.
    pub(crate) skin: Vec3,
}

impl Shading<'_> {
    /// Display-linear colour and coverage of a fragment.
    pub(crate) fn shade(&self, material: Material, v: &Varying) -> [f32; 4] {
        if material == Material::Lashes {
            return lash(v.local);
        }
        let to_eye = (self.eye - v.position).normalize_or(Vec3::Z);
        let mut normal = v.normal.normalize_or(to_eye);
        // At the outline an interpolated normal may lean away from the camera; bend it back to grazing.
        let facing = normal.dot(to_eye);
        if facing < 0.02 {
            normal = (normal + to_eye * (0.02 - facing)).normalize_or(to_eye);
        }
        let radiance = match material {
            Material::Eye => self.eyeball(v, normal, to_eye),
            Material::Teeth => self.surface(Vec3::new(0.72, 0.66, 0.56), v, normal, to_eye, 60.0, 1.0),
            Material::Tongue => self.surface(Vec3::new(0.42, 0.12, 0.11), v, normal, to_eye, 40.0, 1.0),
            Material::Skin | Material::Lashes => {
                // Colour cards of skin are printed yellower than skin is: blood under it takes green away.
                self.surface(self.skin * Vec3::new(1.03, 0.92, 0.97), v, normal, to_eye, 14.0, 0.75)
            }
        };
        let [r, g, b] = tone(radiance).to_array();
        [r, g, b, 1.0]
    }

    /// Diffuse light and a broad highlight under a Fresnel sheen.
    fn surface(&self, albedo: Vec3, v: &Varying, n: Vec3, to_eye: Vec3, shine: f32, gloss: f32) -> Vec3 {
        let diffuse = albedo * v.light;
        let fresnel = schlick(n.dot(to_eye));
        let mirrored = (n * (2.0 * n.dot(to_eye)) - to_eye).normalize_or(n);
        let sheen = self.studio.radiance(mirrored) * (fresnel * v.open.y * 0.28);
        diffuse + (sheen + self.highlight(v, n, to_eye, shine) * 0.035) * gloss
    }

    /// Normalised Blinn-Phong lobes of the key and the rim light; the cosine keeps them off the dark side.
    fn highlight(&self, v: &Varying, n: Vec3, to_eye: Vec3, shine: f32) -> Vec3 {
        let open = [v.open.x, v.open.y];
        self.studio.highlights().into_iter().zip(open).fold(Vec3::ZERO, |sum, ((towards, radiance), open)| {
            let half = (towards + to_eye).normalize_or(n);
            let lobe = libm::powf(n.dot(half).max(0.0), shine) * (shine + 8.0) / 25.0;
            sum + radiance * (lobe * n.dot(towards).max(0.0) * open)
        })
    }

    /// Sclera, iris and pupil by the angle from the eyeball's forward axis (+Z of its own space), under a clear cornea.
    fn eyeball(&self, v: &Varying, n: Vec3, to_eye: Vec3) -> Vec3 {
        let d = v.local.normalize_or(Vec3::Z);
        // Sine of the angle. A visible iris is 11.7 mm wide; the figure's eyeballs are 30 mm, so that it spans asin 0.40.
        let s = (d.x * d.x + d.y * d.y).sqrt();
        let (iris, pupil) = (0.405, 0.155);
        let front = smooth(-0.1, 0.1, d.z);
        let around = libm::atan2f(d.y, d.x);
        let fibres = 0.5 + 0.25 * libm::sinf(around * 37.0) + 0.25 * libm::sinf(around * 61.0 + 1.3);
        let depth = ((s - pupil) / (iris - pupil)).clamp(0.0, 1.0);
        let brown =
            Vec3::new(0.115, 0.052, 0.022).lerp(Vec3::new(0.25, 0.13, 0.055), fibres * (1.0 - 0.5 * depth));
        let limbus = smooth(0.62, 1.0, depth);
        let iris_colour = brown * (1.0 - 0.78 * limbus);
        let sclera = Vec3::new(0.70, 0.655, 0.62) * (1.0 - 0.25 * smooth(0.55, 0.95, s));
        let in_iris = (1.0 - smooth(iris - 0.02, iris + 0.03, s)) * front;
        let in_pupil = (1.0 - smooth(pupil - 0.015, pupil + 0.02, s)) * front;
        let albedo = sclera.lerp(iris_colour, in_iris).lerp(Vec3::splat(0.004), in_pupil);
        // The cornea bulges: over the iris its normal leans outwards more than the eyeball's.
        let axis = self.forward;
        let lean = 0.75 * in_iris;
        let n = (n + (n - axis * n.dot(axis)) * lean).normalize_or(n);
        let fresnel = schlick(n.dot(to_eye));
        let mirrored = (n * (2.0 * n.dot(to_eye)) - to_eye).normalize_or(n);
        let wet = self.studio.radiance(mirrored) * (fresnel * v.open.y * 0.8);
        albedo * v.light + wet + self.highlight(v, n, to_eye, 500.0) * 0.035
    }
}

/// Lashes as strands: dense at the lid, tapering to nothing. `local` is the place relative to the eyeball, whose
/// surface has length 1; the lashes reach from there to about 1.4. Lower lashes are short and thin.
fn lash(local: Vec3) -> [f32; 4] {
    let upper = local.y > 0.0;
    let out = ((local.length() - 1.0) / if upper { 0.38 } else { 0.26 }).clamp(0.0, 1.0);
    // Strands lean away from the nose, and more so towards their tips.
    let along = libm::atan2f(local.x, local.z) * (1.0 - 0.10 * out);
    let uneven = 0.30 * libm::sinf(along * 23.0) + 0.22 * libm::sinf(along * 41.0 + 0.7);
    let strand = 0.5 + 0.5 * libm::cosf(along * 150.0 + 3.0 * uneven);
    let length = (if upper { 0.86 } else { 0.62 }) + 0.30 * uneven;
    let width = (if upper { 0.74 } else { 0.40 }) * (1.0 - out / length).max(0.0);
    let alpha = smooth(1.0 - width - 0.15, 1.0 - width + 0.20, strand) * smooth(0.0, 0.05, length - out);
    [0.016, 0.011, 0.009, alpha * if upper { 0.85 } else { 0.5 }]
}

/// Reflectance of a surface of refractive index 1.4, by the cosine to the eye.
fn schlick(cos: f32) -> f32 {
    let x = (1.0 - cos).clamp(0.0, 1.0);
    0.028 + 0.972 * x * x * x * x * x
}

fn smooth(low: f32, high: f32, x: f32) -> f32 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Soft shoulder into white: linear up to 0.55, then a hyperbola of the same slope that reaches 1 at infinity.
fn tone(c: Vec3) -> Vec3 {
    let shoulder = |x: f32| {
        if x <= 0.55 { x } else { 0.55 + 0.45 * (x - 0.55) / (x - 0.55 + 0.45) }
    };
    Vec3::new(shoulder(c.x.max(0.0)), shoulder(c.y.max(0.0)), shoulder(c.z.max(0.0)))
}
