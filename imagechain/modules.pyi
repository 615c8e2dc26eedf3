"""Every module as a function of its parameters.

Made by ``python -m imagechain.parts.module_stub``.
"""

from collections.abc import Sequence
from os import PathLike
from typing import Literal

from imagechain.parts.module_part import Expression, Part

def read_image(
    *,
    path: str | PathLike[str] | None = None,
    band: int | Expression = 0,
    bands: Literal['one', 'all', 'luminance'] = 'one',
    scale: float | Expression = 1.0,
    offset: float | Expression = 0.0,
    unit: str = 'W/m²/sr',
    fov_x_deg: float | Expression | None = None,
    fov_y_deg: float | Expression | None = None,
    cut_on_um: float | Expression | None = None,
    cut_off_um: float | Expression | None = None,
    missing: Literal['refuse', 'mean', 'zero'] = 'refuse',
) -> Part:
    """Read a picture from a file: ENVI (DIRSIG's format), or another format listed under `path`.

    Samples are the file's numbers times `scale`, plus `offset`. If an ENVI header gives wavelengths
    and you set both `cut_on_um` and `cut_off_um`, the file's bands are integrated between these
    wavelengths. For any other file, the two wavelengths give the band of the samples. The radiance
    is in W/m²/sr, or in W/m²/sr/µm for one spectral band. If the file names its unit (W cm⁻² sr⁻¹
    µm⁻¹, uW/cm^2/sr/um, …) and `scale` is 1, that unit is converted; otherwise `unit` applies. A
    cube whose header names no unit needs `unit` or `scale`. Gains and offsets of an ENVI header are
    applied, and its bad bands are left out. K, DN and similar units are kept. Photons are converted
    to watts only if `bands` is all. An unknown radiance unit is an error.

    A colour picture gives one channel or, with `bands` luminance, all three, weighted by the eye's
    sensitivity. A cube gives one band or plane, by default the first; set `band` for another. With
    `bands` all, a cube with wavelengths in its header gives every band between `cut_on_um` and
    `cut_off_um`. Each band is in W/m²/sr/µm; photons are converted with their energy at the band's
    wavelength. Optics and atmosphere act on each band separately until a detector sums the bands.
    The cube stays on disk.

    An empty field of view is taken from the header. The first row of a FITS picture is at the
    bottom. Samples that are not finite, or that equal the file's no-data value, are an error unless
    `missing` replaces them.

    Parameters
    ----------
    path : str | PathLike[str] | None
        picture file, relative to the network file's folder: Zarr, .npy, EXR, TIFF, PNG, JPEG, JPEG
        2000, BMP, FITS, ENVI, HDR, plain text and others by content: a file name or empty; default
        empty
    band : int | Expression
        band or channel to read, counted from 0: a whole number of at least 0; default 0
    bands : Literal['one', 'all', 'luminance']
        one band, all bands of a spectral cube (each goes through the chain separately), or the
        luminance of a colour picture: one of one, all, luminance; default 'one'
    scale : float | Expression
        factor applied to the samples: a number; default 1.0
    offset : float | Expression
        number added after scaling, in the unit of the scaled samples: a number; default 0.0
    unit : str
        unit of the samples after scaling: text; default 'W/m²/sr'
    fov_x_deg : float | Expression | None
        horizontal field of view [deg]: a number from 0 below 180 or empty; default empty
    fov_y_deg : float | Expression | None
        vertical field of view [deg]: a number from 0 below 180 or empty; default empty
    cut_on_um : float | Expression | None
        shortest wavelength [µm]: a number of at least 0 or empty; default empty
    cut_off_um : float | Expression | None
        longest wavelength [µm]: a number of at least 0 or empty; default empty
    missing : Literal['refuse', 'mean', 'zero']
        samples that are NaN, infinite or missing: refuse them, or replace them with 0 or the mean
        of the other samples: one of refuse, mean, zero; default 'refuse'

    Notes
    -----
    Read Image, in the group Input and output.
    Outputs: image.
    Read-outs: missing_samples (samples).
    """

def test_scene(
    *,
    kind: Literal['dormitory', 'airfield', 'slanted_edge', 'four_bar', 'siemens_star', 'point', 'sine', 'two_panel', 'uniform'] = 'dormitory',
    width: int | Expression = 512,
    height: int | Expression = 512,
    fov_x_deg: float | Expression | None = 30.0,
    fov_y_deg: float | Expression | None = 30.0,
    cut_on_um: float | Expression = 8.0,
    cut_off_um: float | Expression = 12.0,
    bands: int | Expression = 0,
    emissivity: Literal['spectra', 'grey'] = 'spectra',
    quantity: Literal['radiance', 'reflectance'] = 'radiance',
    background_reflectance: float | Expression = 0.07,
    target_reflectance: float | Expression = 0.15,
    sun_elevation_deg: float | Expression = 0.0,
    temperature_K: float | Expression = 303.15,
    delta_K: float | Expression = 10.0,
    angle_deg: float | Expression = 5.0,
    frequency: float | Expression = 16.0,
) -> Part:
    """Draw a radiometric test scene.

    Planck's law converts temperatures and emissivities to band radiance. Edges are area-sampled, so
    they do not alias. The dormitory is a building front with windows, warm and cool areas, sky and
    ground. The airfield is seen from above and has straight roads, for use with Camera Geometry.

    `bands` divides the scene's band into spectral bands of equal width. Optics and atmosphere treat
    each spectral band at its own wavelength until a detector sums the bands. With `bands` above 0,
    surfaces have the spectra of grass, leaves, soil, water, asphalt, concrete, brick, paint and
    glass, coarsely sampled. Surfaces emit at their own temperature and reflect the sky. With
    `sun_elevation_deg`, surfaces also reflect sunlight, which lights scenes from 0.4 to 2.5 µm.
    Targets and their backgrounds are black bodies in all bands. With `emissivity` grey, every
    surface keeps a single emissivity; without sunlight, the bands then add up to the picture for
    `bands` = 0. If `quantity` is reflectance, the samples are surface reflectances, as input for
    Reflected Light. Shade and sky get the reflectance of a sunlit surface of the same brightness.
    If `quantity` is reflectance, targets have `target_reflectance` and their background has
    `background_reflectance`, at all wavelengths.

    Parameters
    ----------
    kind : Literal['dormitory', 'airfield', 'slanted_edge', 'four_bar', 'siemens_star', 'point', 'sine', 'two_panel', 'uniform']
        what to draw: one of dormitory, airfield, slanted_edge, four_bar, siemens_star, point, sine,
        two_panel, uniform; default 'dormitory'
    width : int | Expression
        samples per row: a whole number from 1 to 65536; default 512
    height : int | Expression
        samples per column: a whole number from 1 to 65536; default 512
    fov_x_deg : float | Expression | None
        horizontal field of view [deg]: a number from 0 below 180 or empty; default 30.0
    fov_y_deg : float | Expression | None
        vertical field of view [deg]: a number from 0 below 180 or empty; default 30.0
    cut_on_um : float | Expression
        shortest wavelength [µm]: a number above 0; default 8.0
    cut_off_um : float | Expression
        longest wavelength [µm]: a number above 0; default 12.0
    bands : int | Expression
        number of spectral bands of equal width; 0: a single band: a whole number from 0 to 4096;
        default 0
    emissivity : Literal['spectra', 'grey']
        emissivity of the surfaces if bands is above 0: spectra of the materials, or grey: one of
        spectra, grey; default 'spectra'
    quantity : Literal['radiance', 'reflectance']
        quantity of the samples: radiance, or reflectance for Reflected Light: one of radiance,
        reflectance; default 'radiance'
    background_reflectance : float | Expression
        reflectance of a target's background, used if quantity is reflectance: a number from 0 to 1;
        default 0.07
    target_reflectance : float | Expression
        reflectance of a target, used if quantity is reflectance: a number from 0 to 1; default 0.15
    sun_elevation_deg : float | Expression
        elevation of the sun (0: no sun), used if bands is above 0 [deg]: a number from 0 to 90;
        default 0.0
    temperature_K : float | Expression
        background temperature [K]: a number above 0; default 303.15
    delta_K : float | Expression
        target temperature minus background temperature [K]: a number; default 10.0
    angle_deg : float | Expression
        direction of the edge's normal or of the sine wave, clockwise from horizontal [deg]: a
        number; default 5.0
    frequency : float | Expression
        cycles per frame width (sine) or per shorter side (coarsest bars); number of spokes (star):
        a number above 0; default 16.0

    Notes
    -----
    Test Scene, in the group Input and output.
    Outputs: image.
    """

def write_image(
    *,
    path: str | PathLike[str] | None = None,
    format: Literal['by_suffix', 'exr', 'tif', 'png', 'npy', 'envi'] = 'by_suffix',
    dtype: Literal['automatic', 'float', 'double', 'half', 'uint8', 'uint16'] = 'automatic',
    range_low: float | Expression | None = None,
    range_high: float | Expression | None = None,
) -> Part:
    """Write the picture to a file when a run saves its outputs.

    `imagechain run` saves outputs. In the editor, use Run > Add to the Queue; generating the
    picture writes no file.

    Integer types map `range_low` … `range_high` (empty: the picture's smallest and largest sample)
    to the full range of the type. If `range_low` and `range_high` are empty, a picture in digital
    numbers (DN) is not stretched: 12-bit samples stay 0 to 4095 in the file. `automatic` uses the
    precision of the computation if the format allows it, and 16-bit integers for PNG and for
    digital numbers up to 65535.

    An ENVI file (`.img`, `.bsq`, or `format` envi) keeps all bands of a spectral picture, as floats
    in W/m²/sr/µm. Bands are written one at a time, so the whole cube is never in memory. Every
    other format stores the sum of the bands. A Zarr store (`.zarr`) is written chunk by chunk.

    Parameters
    ----------
    path : str | PathLike[str] | None
        file to write, relative to the network file's folder: a file name or empty; default empty
    format : Literal['by_suffix', 'exr', 'tif', 'png', 'npy', 'envi']
        format of the file; by_suffix: from the suffix of path: one of by_suffix, exr, tif, png,
        npy, envi; default 'by_suffix'
    dtype : Literal['automatic', 'float', 'double', 'half', 'uint8', 'uint16']
        type of the stored samples: one of automatic, float, double, half, uint8, uint16; default
        'automatic'
    range_low : float | Expression | None
        sample stored as 0 by integer types: a number or empty; default empty
    range_high : float | Expression | None
        sample stored as the largest integer of the type: a number or empty; default empty

    Notes
    -----
    Write Image, in the group Input and output.
    Inputs: image.
    """

def write_matrix(
    *,
    path: str | PathLike[str] | None = None,
) -> Part:
    """Write values as plain text, one row per line, readable by MathCad's READPRN.

    A .csv file separates values with commas and names the columns of curves; .txt and .prn files
    use spaces. For bar charts, the first column holds the names of the bars in a .csv file, and
    their numbers, counted from 0, in other files. A transfer function is written in FFT order, zero
    frequency first. Files are written when a run saves its outputs, as for Write Image.

    Parameters
    ----------
    path : str | PathLike[str] | None
        file to write, relative to the network file's folder: a file name or empty; default empty

    Notes
    -----
    Write Matrix, in the group Input and output.
    Inputs: image.
    """

def examine_image(
    *,
    display: Literal['linear', 'log', 'centred_spectrum'] = 'linear',
    probe_x: int | Expression | None = None,
    probe_y: int | Expression | None = None,
    bins: int | Expression = 256,
) -> Part:
    """Report minimum, maximum, mean, standard deviation, histogram and single samples.

    For radiance in a known band, the apparent temperature is also given: a black body at this
    temperature has the same band radiance. Read-outs and probe use the samples themselves (spectra
    in FFT order); the histogram uses the displayed values. A picture's centred spectrum is shown as
    the logarithm of its modulus.

    Parameters
    ----------
    display : Literal['linear', 'log', 'centred_spectrum']
        how the samples are shown: linear, logarithmic, or as a spectrum with zero frequency in the
        middle: one of linear, log, centred_spectrum; default 'linear'
    probe_x : int | Expression | None
        column of the sample to report, counted from 0: a whole number of at least 0 or empty;
        default empty
    probe_y : int | Expression | None
        row of the sample to report, counted from 0: a whole number of at least 0 or empty; default
        empty
    bins : int | Expression
        number of bins of the histogram: a whole number from 1 to 65536; default 256

    Notes
    -----
    Examine Image, in the group Input and output.
    Inputs: image.
    Outputs: table, curve.
    Read-outs: minimum, maximum, mean, sigma.
    """

def init_trans(
    *,
    detector_x_um: float | Expression | None = None,
    detector_y_um: float | Expression | None = None,
    focal_length_mm: float | Expression | None = None,
    f_number: float | Expression | None = None,
    obscuration_ratio: float | Expression | None = None,
    range_m: float | Expression | None = None,
    fill_x: float | Expression | None = 1.0,
    fill_y: float | Expression | None = 1.0,
    fov_x_deg: float | Expression | None = None,
    fov_y_deg: float | Expression | None = None,
    platform: Literal['line', 'push', 'array'] = 'line',
    velocity_m_per_s: float | Expression = 0.0,
    scan_velocity_mrad_per_s: float | Expression = 0.0,
    edges: Literal['reflect', 'periodic'] = 'reflect',
) -> Part:
    """Transform the image to magnitude and phase, and pass the geometry to the other modules.

    Empty parameters take their values from a Camera before this module, otherwise from the image's
    header. A fill factor of 1 is treated as empty. Values entered here take priority; a warning
    reports any difference. Source: Tantalo 1996, section 4.1.

    Parameters
    ----------
    detector_x_um : float | Expression | None
        horizontal detector pitch [µm]: a number of at least 0 or empty; default empty
    detector_y_um : float | Expression | None
        vertical detector pitch [µm]: a number of at least 0 or empty; default empty
    focal_length_mm : float | Expression | None
        effective focal length [mm]: a number of at least 0 or empty; default empty
    f_number : float | Expression | None
        F-number: a number of at least 0 or empty; default empty
    obscuration_ratio : float | Expression | None
        obscuration: inner diameter of the aperture divided by its outer diameter; empty: from
        Camera, or no obscuration: a number from 0 below 1 or empty; default empty
    range_m : float | Expression | None
        altitude, or distance to the scene [m]: a number of at least 0 or empty; default empty
    fill_x : float | Expression | None
        horizontal fill factor; empty: 1: a number from 0 to 1 or empty; default 1.0
    fill_y : float | Expression | None
        vertical fill factor; empty: 1: a number from 0 to 1 or empty; default 1.0
    fov_x_deg : float | Expression | None
        horizontal field of view [deg]: a number from 0 below 180 or empty; default empty
    fov_y_deg : float | Expression | None
        vertical field of view [deg]: a number from 0 below 180 or empty; default empty
    platform : Literal['line', 'push', 'array']
        how the detectors collect the picture: line scanner, pushbroom line or staring array: one of
        line, push, array; default 'line'
    velocity_m_per_s : float | Expression
        velocity of the platform or object; 0: from Camera's orbit; without an orbit, no motion
        [m/s]: a number; default 0.0
    scan_velocity_mrad_per_s : float | Expression
        scan velocity [mrad/s]: a number of at least 0; default 0.0
    edges : Literal['reflect', 'periodic']
        how the frame continues beyond its edges: mirrored, or repeated as in a plain FFT: one of
        reflect, periodic; default 'reflect'

    Notes
    -----
    Init & Trans, in the group Transform.
    Inputs: image.
    Outputs: context, magnitude, phase.
    Read-outs: interval_x_mrad (mrad), interval_y_mrad (mrad), ifov_x_mrad (mrad), ifov_y_mrad
    (mrad), frequency_interval_x (cyc/mrad), frequency_interval_y (cyc/mrad), nyquist_x (cyc/mrad),
    nyquist_y (cyc/mrad), pixel_nyquist_x (cyc/mrad), pixel_nyquist_y (cyc/mrad), oversampling_x
    (samples), oversampling_y (samples).
    """

def back_transform(
) -> Part:
    """Compute the image from a magnitude and a phase.

    Magnitude and phase may come from different images A and B of the same size. The result then has
    the spectrum |A|·exp(i·∠B) and periodic edges. Source: Tantalo 1996, section 4.1.

    Notes
    -----
    Back Transform, in the group Transform.
    Inputs: magnitude, phase.
    Outputs: image.
    """

def combine_pixels(
    *,
    factor_x: int | Expression = 2,
    factor_y: int | Expression = 1,
    mode: Literal['mean', 'sum'] = 'mean',
) -> Part:
    """Combine each block of samples into one pixel.

    Rows and columns left over at the bottom and right are dropped: 512 samples in blocks of 3 give
    170 pixels. Directly after Back Transform, if the factors divide the picture's size exactly, the
    module folds the spectrum instead of combining samples. The mean of a block represents the
    pixel's averaging over its area. After Detector MTF, which already averages over the pixel, use
    Sample Pixels instead. Source: Tantalo 1996, section 4.1, fig. 4.6.

    Parameters
    ----------
    factor_x : int | Expression
        samples per pixel, horizontally: a whole number from 1 to 65536; default 2
    factor_y : int | Expression
        samples per pixel, vertically: a whole number from 1 to 65536; default 1
    mode : Literal['mean', 'sum']
        mean (radiance) or sum (counts) of each block: one of mean, sum; default 'mean'

    Notes
    -----
    Combine Pixels, in the group Transform.
    Inputs: image.
    Outputs: image.
    """

def sample_pixels(
    *,
    factor_x: float | Expression | None = None,
    factor_y: float | Expression | None = None,
    offset: float | Expression = 0.0,
    offset_y: float | Expression | None = None,
) -> Part:
    """Keep one sample for each pixel, after Detector MTF has averaged over the pixel.

    Combine Pixels would average over the pixel again and leave only 0.64 of the contrast at
    Nyquist. The samples lie at the centres of the pixels, so the picture does not move. For even
    and non-integer ratios, the centres lie between samples. Between samples, the picture is
    evaluated as its Fourier sum: exact to rounding, with edges mirrored or periodic as in Back
    Transform. Nothing is filtered: content beyond the pixels' Nyquist frequency aliases, as in a
    camera. Incomplete pixels at the right and bottom edges of the frame are dropped. Source: Park,
    Schowengerdt and Kaczynski 1984, Applied Optics 23, 2572 (the average over the pixel and its
    sampling are two stages).

    Parameters
    ----------
    factor_x : float | Expression | None
        samples per pixel, horizontally; empty: from the pitch of Init & Trans or Camera [samples]:
        a number from 0.001 to 65536 or empty; default empty
    factor_y : float | Expression | None
        samples per pixel, vertically; empty: from the pitch of Init & Trans or Camera [samples]: a
        number from 0.001 to 65536 or empty; default empty
    offset : float | Expression
        offset of the samples from the pixels' centres, to the right and down [pixels]: a number
        from -1 to 1; default 0.0
    offset_y : float | Expression | None
        downward offset, if different; empty: equal to offset [pixels]: a number from -1 to 1 or
        empty; default empty

    Notes
    -----
    Sample Pixels, in the group Transform.
    Inputs: image.
    Outputs: image.
    Read-outs: nyquist_x (cyc/mrad), nyquist_y (cyc/mrad).
    """

def anti_alias(
    *,
    kernel: Literal['box', 'gaussian', 'lanczos'] = 'box',
    factor: int | Expression = 1,
) -> Part:
    """Filter out frequencies that would alias in a picture decimated by `factor`.

    No sample is dropped. Use this filter before Interpolate decimates with order 0, if there is no
    Detector MTF. `box` is the mean of `factor` samples, centred for even factors too. `gaussian`
    halves the contrast at the new Nyquist frequency.
    `lanczos` is a sinc with its cutoff at the new Nyquist frequency and a three-lobe window. The
    frame is mirrored at its edges. A factor of 1 changes nothing. Sources: Tantalo 1996, section
    4.1; Duchon 1979 (Lanczos).

    Parameters
    ----------
    kernel : Literal['box', 'gaussian', 'lanczos']
        shape of the low-pass filter: one of box, gaussian, lanczos; default 'box'
    factor : int | Expression
        factor of the later decimation [samples]: a whole number from 1 to 1024; default 1

    Notes
    -----
    Anti-alias Filter, in the group Transform.
    Inputs: image.
    Outputs: image.
    Read-outs: new_nyquist_x (cyc/mrad), new_nyquist_y (cyc/mrad).
    """

def interpolate(
    *,
    width: int | Expression | None = None,
    height: int | Expression | None = None,
    order: Literal[0, 1, 3] = 1,
) -> Part:
    """Resample the picture to another size over the same field of view.

    The centres of the outermost samples lie half a sampling interval inside the frame's edges.
    Beyond the edges, a picture from Back Transform continues as Init & Trans defines: a mirrored
    frame is mirrored, and a periodic frame wraps round. Any other picture, or one cropped after
    Back Transform, continues with its outermost samples. Nothing is filtered: a smaller picture
    aliases, as in a frame grabber. Order 0 takes the nearest sample (of two equally near samples,
    the one further right or down), order 1 is bilinear, and order 3 is cubic convolution. With an
    unchanged size, the picture does not change. Sources: Tantalo 1996, sections 5.1 and 5.2
    (bilinear); Keys 1981 (cubic, a = −1/2).

    Parameters
    ----------
    width : int | Expression | None
        samples per row; empty: unchanged: a whole number from 1 to 65536 or empty; default empty
    height : int | Expression | None
        samples per column; empty: unchanged: a whole number from 1 to 65536 or empty; default empty
    order : Literal[0, 1, 3]
        0 nearest, 1 bilinear, 3 cubic: one of 0, 1, 3; default 1

    Notes
    -----
    Interpolate, in the group Transform.
    Inputs: image.
    Outputs: image.
    """

def to_radiance(
    *,
    emissivity: float | Expression = 1.0,
    surroundings_K: float | Expression | None = None,
    cut_on_um: float | Expression | None = None,
    cut_off_um: float | Expression | None = None,
) -> Part:
    """Convert a picture of temperatures to radiance, by Planck's law in the band.

    The radiance is ε·L(T) + (1 − ε)·L(surroundings); without surroundings nothing is reflected. The
    picture's unit, set on Read Image, must be a temperature (K, °C, °F, mK): digital numbers and
    radiance are refused. An image of emissivities can replace the single value. Sources:
    Planck's and Kirchhoff's laws; Holst 2000, Common Sense Approach to Thermal Imaging.

    Parameters
    ----------
    emissivity : float | Expression
        emissivity of all samples, if no emissivity image is connected: a number above 0 to 1;
        default 1.0
    surroundings_K : float | Expression | None
        temperature of the reflected surroundings; empty: nothing is reflected [K]: a number from 0
        to 10000 or empty; default empty
    cut_on_um : float | Expression | None
        shortest wavelength; empty: from the image's band [µm]: a number of at least 0 or empty;
        default empty
    cut_off_um : float | Expression | None
        longest wavelength; empty: from the image's band [µm]: a number of at least 0 or empty;
        default empty

    Notes
    -----
    To Radiance, in the group Transform.
    Inputs: image, emissivity (optional).
    Outputs: image.
    """

def to_temperature(
    *,
    emissivity: float | Expression = 1.0,
    surroundings_K: float | Expression | None = None,
    cut_on_um: float | Expression | None = None,
    cut_off_um: float | Expression | None = None,
) -> Part:
    """Convert a picture of band radiance to temperatures in kelvin.

    This is the inverse of To Radiance: T is the temperature at which Planck's law gives the
    radiance (L − (1 − ε)·L(surroundings))/ε in the band. With an emissivity of 1, the result is the
    apparent, or brightness, temperature. The picture's unit must be band radiance in watts
    (W/m²/sr, mW/cm²/sr, …): temperatures, digital numbers, photons and spectral radiance are
    refused. An image of emissivities can replace the single value. Sources: as for To Radiance.

    Parameters
    ----------
    emissivity : float | Expression
        emissivity of all samples, if no emissivity image is connected: a number above 0 to 1;
        default 1.0
    surroundings_K : float | Expression | None
        temperature of the reflected surroundings; empty: nothing is reflected [K]: a number from 0
        to 10000 or empty; default empty
    cut_on_um : float | Expression | None
        shortest wavelength; empty: from the image's band [µm]: a number of at least 0 or empty;
        default empty
    cut_off_um : float | Expression | None
        longest wavelength; empty: from the image's band [µm]: a number of at least 0 or empty;
        default empty

    Notes
    -----
    To Temperature, in the group Transform.
    Inputs: image, emissivity (optional).
    Outputs: image.
    """

def reflected_light(
    *,
    sun: Literal['standard', 'black_body'] = 'standard',
    solar_irradiance: float | Expression | None = None,
    path: str | PathLike[str] | None = None,
    sun_elevation_deg: float | Expression = 45.0,
    optical_depth: float | Expression = 0.0,
    sky: float | Expression = 0.0,
    illuminance_lux: float | Expression | None = None,
    cut_on_um: float | Expression | None = None,
    cut_off_um: float | Expression | None = None,
    bands: int | Expression = 1,
) -> Part:
    """Convert a picture of reflectances to radiance under sun and sky.

    For horizontal Lambertian surfaces: L = ρ·(E_sun·e^(−τm)·sin h + π·L_sky)/π, integrated over the
    band. h is the sun's elevation, τ the zenith optical depth of the air, and m the air mass. E_sun
    is the standard solar spectrum (ASTM G173, extended beyond 4 µm by a black body) or a black body
    of 5800 K (1388 W/m² in total, 16 % too low at 1.6 µm), as set by `sun`. The number in
    `solar_irradiance` or the CSV file in `path` replaces this spectrum.
    The sky has the same radiance in all directions. The picture's unit, set on Read Image, must be
    1, %, reflectance or albedo. A picture with one band has the same reflectance at all
    wavelengths. With `bands` above 1, the radiance has that many bands; a cube of reflectances
    keeps its own bands. Add Atmospheric Path for the path from the surface to the camera.

    `illuminance_lux` scales sun and sky to give this illuminance on the ground: 100 000 lx in
    sunlight, 1000 under an overcast sky, 0.1 at full moon, 0.01 at quarter moon, 0.001 in
    starlight. Scaling does not change the shape of the spectrum. Moonlight has nearly the spectrum
    of sunlight. Starlight does not: airglow makes the night sky a thousand times brighter at 1.6 µm
    than at 0.4 µm. For starlight, give the spectrum of the night sky in `path`.

    Sources: Lambert 1760; Kasten and Young 1989 (air mass); ASTM G173-03 (Gueymard 2004, Solar
    Energy 76, 423); nominal solar radius of the IAU, 2015 (black body); CIE 018:2019, V(λ); RCA
    1974, Electro-Optics Handbook (illuminance); Ellis et al. 2011 (airglow).

    Parameters
    ----------
    sun : Literal['standard', 'black_body']
        solar spectrum above the atmosphere: the standard ASTM G173, or a black body of 5800 K: one
        of standard, black_body; default 'standard'
    solar_irradiance : float | Expression | None
        solar irradiance above the atmosphere at normal incidence, used instead of the spectrum;
        empty: from `sun` [W/m²/µm]: a number from 0 to 1e+12 or empty; default empty
    path : str | PathLike[str] | None
        CSV of wavelength (µm) and solar irradiance (W/m²/µm), used instead of `sun` and
        solar_irradiance; empty: no file: a file name or empty; default empty
    sun_elevation_deg : float | Expression
        elevation of the sun above the horizon [deg]: a number from 0 to 90; default 45.0
    optical_depth : float | Expression
        zenith optical depth of the air, for sunlight: a number from 0 to 1000; default 0.0
    sky : float | Expression
        spectral radiance of the sky, equal in all directions [W/m²/sr/µm]: a number from 0 to
        1e+12; default 0.0
    illuminance_lux : float | Expression | None
        illuminance on the ground to which sun and sky are scaled; empty: no scaling [lx]: a number
        above 0 to 1e+09 or empty; default empty
    cut_on_um : float | Expression | None
        shortest wavelength; empty: from the image's band [µm]: a number of at least 0 or empty;
        default empty
    cut_off_um : float | Expression | None
        longest wavelength; empty: from the image's band [µm]: a number of at least 0 or empty;
        default empty
    bands : int | Expression
        number of bands into which the radiance is divided: a whole number from 1 to 10000; default
        1

    Notes
    -----
    Reflected Light, in the group Atmosphere.
    Inputs: image.
    Outputs: image, table.
    Read-outs: air_mass, irradiance (W/m²), illuminance (lx).
    """

def atmospheric_path(
    *,
    model: Literal['transmission', 'extinction_per_km', 'visibility_km', 'modtran', 'modtran_tables'] = 'transmission',
    transmission: float | Expression = 1.0,
    path: str | PathLike[str] | None = None,
    extinction_per_km: float | Expression = 0.2,
    visibility_km: float | Expression = 23.0,
    angstrom_q: float | Expression = 0.0,
    haze: Literal['rural_23_km', 'rural_5_km'] = 'rural_23_km',
    altitude_m: float | Expression | None = None,
    range_m: float | Expression | None = None,
    air_K: float | Expression | None = None,
    source_K: float | Expression | None = None,
) -> Part:
    """Attenuate a picture's radiance by the atmosphere, and add the path radiance: τ·L + L_path.

    `transmission`: a number, or a CSV of wavelength (µm) and transmission. `extinction_per_km`: the
    transmission is exp(−β·R). `visibility_km`: Koschmieder's β = 3.912/V at 0.55 µm, times
    (0.55/λ)^q. `modtran`: a tape7 or the JSON output of MODTRAN (columns FREQ, TOT TRANS and the
    path radiances; 10⁸/λ² converts W/cm²/sr per cm⁻¹ to W/m²/sr/µm), or a CSV of wavelength_um,
    transmission, path_radiance (W/m²/sr/µm). MODTRAN's data contain the path radiance; with other
    models, it is (1 − τ) times the radiance of a black body at `air_K`.

    `modtran_tables`: pyBSM's tables of MODTRAN 5.2.1, 0.3 to 14 µm, for a target on the ground, a
    mid-latitude summer and the sun 40° above the horizon. Between the tables, −ln τ/R and L_path/(1
    − τ) are interpolated over height and ground range. With every second table left out as a test,
    a band's transmission is off by 0.007 rms and 0.06 at most. Air above 24.5 km is neglected: at
    nadir, from 0.5 to 0.8 µm, this raises the transmission from 0.681 to 0.688. Install the extra
    `atmosphere` to use `modtran_tables`.

    A picture with one band is multiplied by the band's mean transmission. The mean is weighted by
    the radiance of a black body. The black body's temperature is `source_K` if given, otherwise
    5800 K (sunlight) if the band begins below 2.5 µm, otherwise the picture's mean brightness
    temperature. In a spectral picture (`bands` of Read Image), each band is multiplied by its own
    transmission. Absorption and scattering both count as attenuation here; for the blur from
    scattering, use Atmosphere MTF. A Figures of Merit module after this one scales the transmission
    to each range with Beer's law at every wavelength. Two Atmospheric Path modules in a row
    represent two constituents of the same air. Put the module after Camera to use Camera's range
    and orbit; otherwise enter `range_m` here.

    Sources: Bouguer 1729; Koschmieder 1924; Ångström 1929; Berk et al. 2011 (MODTRAN).

    Parameters
    ----------
    model : Literal['transmission', 'extinction_per_km', 'visibility_km', 'modtran', 'modtran_tables']
        model of the air: a transmission, an extinction, a visibility, a MODTRAN file, or pyBSM's
        MODTRAN tables: one of transmission, extinction_per_km, visibility_km, modtran,
        modtran_tables; default 'transmission'
    transmission : float | Expression
        transmission of the path: a number from 0 to 1; default 1.0
    path : str | PathLike[str] | None
        CSV of wavelength (µm) and transmission, used instead of `transmission`; for modtran: a
        tape7, JSON or CSV: a file name or empty; default empty
    extinction_per_km : float | Expression
        extinction coefficient: absorption plus scattering [1/km]: a number from 0 to 1e+06; default
        0.2
    visibility_km : float | Expression
        visibility (2 % contrast) [km]: a number above 0 to 1e+06; default 23.0
    angstrom_q : float | Expression
        Ångström exponent q: the extinction coefficient is proportional to wavelength^−q: a number
        from -5 to 5; default 0.0
    haze : Literal['rural_23_km', 'rural_5_km']
        haze type and visibility of MODTRAN's tables: one of rural_23_km, rural_5_km; default
        'rural_23_km'
    altitude_m : float | Expression | None
        height of the camera above the ground, for MODTRAN's tables; empty: from Camera's orbit [m]:
        a number from 0 to 1e+08 or empty; default empty
    range_m : float | Expression | None
        length of the path; empty: from a Camera before this node, or from Init & Trans if context
        is connected [m]: a number from 0 to 1e+09 or empty; default empty
    air_K : float | Expression | None
        temperature of the air; empty: no path radiance [K]: a number from 0 to 10000 or empty;
        default empty
    source_K : float | Expression | None
        temperature of the black body that weights a single band; empty: 5800 K if the band begins
        below 2.5 µm, else the brightness temperature of the picture's mean [K]: a number from 0 to
        1e+06 or empty; default empty

    Notes
    -----
    Atmospheric Path, in the group Atmosphere.
    Inputs: image, context (optional).
    Outputs: image, table.
    Read-outs: transmission, path_radiance (W/m²/sr), optical_depth.
    """

def atmosphere_mtf(
    *,
    apply: Literal['multiply', 'filter_only'] = 'multiply',
    turbulence: Literal['gaussian', 'long_exposure', 'short_exposure', 'none'] = 'gaussian',
    fwhm_mrad: float | Expression = 0.0,
    fried_r0_m: float | Expression | None = None,
    wavelength_um: float | Expression | None = None,
    r0_wavelength_um: float | Expression | None = None,
    aperture_mm: float | Expression | None = None,
    alpha: float | Expression = 0.5,
    cn2: float | Expression | None = None,
    turbidity: Literal['none', 'low', 'moderate', 'high', 'custom'] = 'none',
    scatter_depth: float | Expression | None = None,
    turbidity_cutoff_cyc_per_mrad: float | Expression = 0.001,
    particle_radius_um: float | Expression | None = None,
    view: Literal['horizontal', 'vertical', 'up'] = 'horizontal',
    absorption_per_km: float | Expression = 0.0,
    scattering_per_km: float | Expression = 0.0,
    scale_height_km: float | Expression = 1.0,
) -> Part:
    """Blur by atmospheric turbulence and aerosol scattering (turbidity).

    `turbulence` selects a Gaussian blur of a given width, or Fried's long- or short-exposure MTF.
    r0 is entered or, if empty, computed from a Cn² profile. The turbidity MTF is exp(−τ(ρ/ρc)²) up
    to ρc and a plateau of exp(−τ) beyond it. τ comes from the aerosol level (plateau 0.99, 0.975 or
    0.955) or, if `turbidity` is custom, from a number or the scattering coefficient along the path.
    On a downward or upward path, the scattering coefficient falls exponentially with height.
    Absorption attenuates all frequencies equally and does not blur; for absorption, use Atmospheric
    Path. The blur is stronger on an upward path than on a downward path, because the strongest
    turbulence of an upward path is near the aperture. r0 scales with λ^(6/5), and the aerosol
    cutoff ρc with 1/λ. Each band of a spectral picture is blurred at its own wavelength.

    Sources: Tantalo 1996, section 4.2; Fried 1966; Sadot and Kopeika 1992.

    Parameters
    ----------
    apply : Literal['multiply', 'filter_only']
        multiply the input by the transfer function, or output the transfer function alone: one of
        multiply, filter_only; default 'multiply'
    turbulence : Literal['gaussian', 'long_exposure', 'short_exposure', 'none']
        turbulence model: one of gaussian, long_exposure, short_exposure, none; default 'gaussian'
    fwhm_mrad : float | Expression
        full width at half maximum of the Gaussian blur [mrad]: a number of at least 0; default 0.0
    fried_r0_m : float | Expression | None
        Fried parameter r0; empty: from Cn² [m]: a number of at least 0 or empty; default empty
    wavelength_um : float | Expression | None
        wavelength of the blur; empty: the middle of the band, or of each band of a cube [µm]: a
        number of at least 0 or empty; default empty
    r0_wavelength_um : float | Expression | None
        wavelength for which r0 is given, often 0.5 µm; empty: the wavelength of the blur [µm]: a
        number of at least 0 or empty; default empty
    aperture_mm : float | Expression | None
        aperture diameter, for a short exposure; empty: from Camera [mm]: a number of at least 0 or
        empty; default empty
    alpha : float | Expression
        α for a short exposure, 1 in the near field and 0.5 in the far field: a number from 0 to 1;
        default 0.5
    cn2 : float | Expression | None
        Cn² along a horizontal path, or at the ground for a vertical path [m^(-2/3)]: a number of at
        least 0 or empty; default empty
    turbidity : Literal['none', 'low', 'moderate', 'high', 'custom']
        aerosol level; custom: τ from scatter_depth or, if empty, from scattering_per_km: one of
        none, low, moderate, high, custom; default 'none'
    scatter_depth : float | Expression | None
        optical depth τ, used when turbidity is custom; empty: from scattering_per_km: a number of
        at least 0 or empty; default empty
    turbidity_cutoff_cyc_per_mrad : float | Expression
        cutoff frequency: particle radius over wavelength [cyc/mrad]: a number above 0; default
        0.001
    particle_radius_um : float | Expression | None
        particle radius, which sets the cutoff (radius over wavelength); empty: from
        turbidity_cutoff_cyc_per_mrad [µm]: a number from 0 to 1e+06 or empty; default empty
    view : Literal['horizontal', 'vertical', 'up']
        line of sight, used with scattering_per_km and Cn²; vertical: looking down from a height;
        up: looking up to a height: one of horizontal, vertical, up; default 'horizontal'
    absorption_per_km : float | Expression
        absorption coefficient, which has no effect here: absorption attenuates the scene without
        blurring it; use Atmospheric Path [1/km]: a number of at least 0; default 0.0
    scattering_per_km : float | Expression
        scattering coefficient, used when turbidity is custom [1/km]: a number of at least 0;
        default 0.0
    scale_height_km : float | Expression
        scale height of the aerosol, used when looking down or up [km]: a number above 0; default
        1.0

    Notes
    -----
    Atmosphere MTF, in the group Atmosphere.
    Inputs: context, magnitude.
    Outputs: magnitude, mtf.
    Read-outs: mtf_at_nyquist_x, mtf_at_nyquist_y, mtf_at_pixel_nyquist_x, mtf_at_pixel_nyquist_y,
    r0_m (m), optical_depth, largest_change, negligible.
    """

def camera(
    *,
    pixels_x: int | Expression | None = None,
    pixels_y: int | Expression | None = None,
    pitch_um: float | Expression | None = None,
    pitch_y_um: float | Expression | None = None,
    fill_x: float | Expression | None = None,
    fill_y: float | Expression | None = None,
    focal_length_mm: float | Expression | None = None,
    f_number: float | Expression | None = None,
    aperture_mm: float | Expression | None = None,
    obscuration_ratio: float | Expression = 0.0,
    t_number: float | Expression | None = None,
    irradiance: Literal['disc', 'sine'] = 'disc',
    range_m: float | Expression | None = None,
    altitude_km: float | Expression | None = None,
    look_angle_deg: float | Expression = 0.0,
    look_direction: Literal['across', 'along'] = 'across',
) -> Part:
    """Enter a camera's data once, for Init & Trans and all modules after it.

    The image passes through unchanged and carries the data. Init & Trans and all modules after it
    use pitch, focal length, F-number, fill factor and range. Diffraction MTF uses aperture and
    obscuration, and Sample Pixels uses the pitch. Init & Trans uses the data for parameters left
    empty there. Any two of focal length, F-number and aperture determine the third. An image
    without a sampling interval gets one from the IFOV on the axis. So does an image with the
    same field of view as the lens, 2·atan(Np/2f): a wide field must not be divided into equal
    angles. A warning names values that disagree; nothing is corrected.

    On a satellite, altitude and look angle give range, elevation and the velocity of the scene
    across the line of sight. The orbit is circular and the Earth a sphere. The Earth's rotation is
    neglected. In a low orbit, it changes the speed by up to 7 % or the direction by up to 4°
    (`yaw_deg` of TDI MTF); in a high orbit, it changes them more. Above an altitude of 2000 km, a
    warning states the error in speed.

    The obscuration blocks light: electrons, NETD and SNR use the open share of the aperture, 1 −
    ε², and the F-number of the full aperture. A T-number replaces F-number, obscuration and
    transmission in radiometry; diffraction keeps the F-number. `irradiance` sets how the light
    depends on the F-number or T-number: `disc` (π/(4F² + 1)) is exact for a flat pupil seen from
    the axis and usual in infrared work. `sine` (π/(4F²)) is exact for a lens corrected for coma,
    such as a fast photographic or infrared lens. The values of `disc` and `sine` differ by 25 % at
    F/1 and by 1.6 % at F/4. Sources: Holst 2008, Electro-Optical Imaging System Performance,
    chapters 2 and 10 (IFOV, F-number, GSD); Kingslake 1983, Optical System Design, chapter 6
    (sine condition, T-number); Wertz and Larson 1999, Space Mission Analysis and Design, chapter 5
    (orbit).

    Parameters
    ----------
    pixels_x : int | Expression | None
        pixels per row [pixels]: a whole number from 0 to 1e+06 or empty; default empty
    pixels_y : int | Expression | None
        pixels per column [pixels]: a whole number from 0 to 1e+06 or empty; default empty
    pitch_um : float | Expression | None
        horizontal pixel pitch [µm]: a number of at least 0 or empty; default empty
    pitch_y_um : float | Expression | None
        vertical pixel pitch; empty: equal to pitch_um [µm]: a number of at least 0 or empty;
        default empty
    fill_x : float | Expression | None
        horizontal fill factor; empty: 1: a number from 0 to 1 or empty; default empty
    fill_y : float | Expression | None
        vertical fill factor; empty: 1: a number from 0 to 1 or empty; default empty
    focal_length_mm : float | Expression | None
        focal length; empty: F-number times aperture [mm]: a number of at least 0 or empty; default
        empty
    f_number : float | Expression | None
        F-number; empty: focal length divided by the aperture: a number of at least 0 or empty;
        default empty
    aperture_mm : float | Expression | None
        aperture diameter; empty: focal length divided by the F-number [mm]: a number of at least 0
        or empty; default empty
    obscuration_ratio : float | Expression
        obscuration: inner diameter of the aperture divided by its outer diameter: a number from 0
        below 1; default 0.0
    t_number : float | Expression | None
        T-number: F-number of a lossless, unobscured lens that passes the same amount of light;
        empty: from F-number, obscuration and transmission: a number of at least 0 or empty; default
        empty
    irradiance : Literal['disc', 'sine']
        how the light depends on the F-number: π/(4F² + 1), or π/(4F²) for a lens that obeys the
        sine condition: one of disc, sine; default 'disc'
    range_m : float | Expression | None
        distance to the scene [m]: a number of at least 0 or empty; default empty
    altitude_km : float | Expression | None
        altitude of a circular orbit; empty: the camera is not on a satellite [km]: a number above 0
        to 100000 or empty; default empty
    look_angle_deg : float | Expression
        angle of the line of sight off nadir [deg]: a number from 0 to 89; default 0.0
    look_direction : Literal['across', 'along']
        direction of the look angle: across the track, or ahead along it: one of across, along;
        default 'across'

    Notes
    -----
    Camera, in the group Optics.
    Inputs: image.
    Outputs: image, camera.
    Read-outs: pixel_x_mrad (mrad), pixel_y_mrad (mrad), fov_x_deg (deg), fov_y_deg (deg), nyquist_x
    (cyc/mrad), nyquist_y (cyc/mrad), f_number, aperture_mm (mm), samples_per_pixel_x (samples),
    samples_per_pixel_y (samples), cutoff (cyc/mrad), q, gsd_x_m (m), gsd_y_m (m), elevation_deg
    (deg), ground_speed_m_per_s (m/s), velocity_m_per_s (m/s), gsd_ground_x_m (m), gsd_ground_y_m
    (m), line_rate_Hz (Hz).
    """

def diffraction_mtf(
    *,
    aperture_mm: float | Expression | None = None,
    obscuration_ratio: float | Expression | None = None,
    cut_on_um: float | Expression | None = None,
    cut_off_um: float | Expression | None = None,
    weighting: Literal['photons', 'energy', 'uniform'] = 'photons',
    source_K: float | Expression | None = None,
    response: str | PathLike[str] | None = None,
    wavelengths: Literal['auto', 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 12, 16, 20, 24, 32, 48, 64] = 'auto',
    tolerance: float | Expression = 0.0,
    defocus_waves: float | Expression = 0.0,
    rms_wavefront_waves: float | Expression = 0.0,
    apply: Literal['multiply', 'filter_only'] = 'multiply',
) -> Part:
    """Blur by diffraction at a circular or annular aperture, computed exactly over the band.

    Aperture and obscuration come from Camera. Without a Camera, the aperture is the focal length
    divided by the F-number, both from Init & Trans. No pupil array is needed. Over a band,
    `weighting` weights each wavelength's OTF by the photons or the energy of a black body, or
    equally, as in Tantalo 1996. The black body's temperature is `source_K`. If `source_K` is empty,
    the temperature is 5800 K (sunlight) for a band that begins below 2.5 µm, and otherwise the
    brightness temperature of the picture's mean radiance. `response`, and a Spectral Response
    before this module, also weight the light, like a detector behind the optics. With `wavelengths`
    set to auto, the module uses as many wavelengths as `tolerance` requires. At each frequency, the
    band is split at the wavelengths where the OTF has a kink, such as its cut-off. A number sets
    how many wavelengths sample the band; 1 uses the band's middle. With auto, a spectral picture is
    blurred band by band, and the MTF shown is the mean weighted by the picture's own light.

    `defocus_waves` is W20 at the rim of the pupil, in waves at the band's middle; the OTF stays
    real and may be negative. `rms_wavefront_waves`, also in waves at the band's middle, applies
    Shannon's factor for small errors of any shape, 1 − (W/0.18)²(1 − 4(ν − 1/2)²). Sources: Goodman
    2005; O'Neill 1956 (annulus, with its erratum); Hopkins 1955 (defocus); Shannon 1994, Handbook
    of Optics I, chapter 35.

    Parameters
    ----------
    aperture_mm : float | Expression | None
        aperture diameter; empty: from Camera, or focal length divided by the F-number [mm]: a
        number of at least 0 or empty; default empty
    obscuration_ratio : float | Expression | None
        obscuration: inner over outer diameter of the aperture; empty: from Camera, or no
        obscuration: a number from 0 below 1 or empty; default empty
    cut_on_um : float | Expression | None
        shortest wavelength; empty: from the image's band [µm]: a number of at least 0 or empty;
        default empty
    cut_off_um : float | Expression | None
        longest wavelength; empty: from the image's band [µm]: a number of at least 0 or empty;
        default empty
    weighting : Literal['photons', 'energy', 'uniform']
        weighting of the wavelengths: by photons (as in a photon detector), by energy, or equal: one
        of photons, energy, uniform; default 'photons'
    source_K : float | Expression | None
        temperature of the black body that weights the band; empty: 5800 K if the band begins below
        2.5 µm, else the brightness temperature of the picture's mean [K]: a number from 0 to 1e+06
        or empty; default empty
    response : str | PathLike[str] | None
        CSV file of wavelength (µm) and detector response, which also weights the light; empty:
        equal at all wavelengths: a file name or empty; default empty
    wavelengths : Literal['auto', 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 12, 16, 20, 24, 32, 48, 64]
        auto: as many wavelengths as the tolerance requires; a number sets how many sample the band;
        1 uses the band's middle: one of auto, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 12, 16, 20, 24, 32,
        48, 64; default 'auto'
    tolerance : float | Expression
        largest OTF error allowed with auto; 0 means 1e-13, or 1e-10 with defocus, or 1e-6 with a
        response of many points: a number from 0 to 1; default 0.0
    defocus_waves : float | Expression
        defocus W20 at the rim of the pupil [waves]: a number from -20 to 20; default 0.0
    rms_wavefront_waves : float | Expression
        rms wavefront error of any shape [waves]: a number from 0 to 0.18; default 0.0
    apply : Literal['multiply', 'filter_only']
        multiply the input by the transfer function, or output the transfer function alone: one of
        multiply, filter_only; default 'multiply'

    Notes
    -----
    Diffraction MTF, in the group Optics.
    Inputs: context, magnitude, phase (optional).
    Outputs: magnitude, phase, mtf, ptf.
    Read-outs: mtf_at_nyquist_x, mtf_at_nyquist_y, mtf_at_pixel_nyquist_x, mtf_at_pixel_nyquist_y,
    aperture_mm (mm), cutoff (cyc/mrad), weighting_K (K), wavelengths_used, estimated_error.
    """

def exit_pupil(
    *,
    shape: Literal['clear', 'half_moon', 'cassegrain', 'hinged', 'cassegrain_slit', 'spider', 'file'] = 'clear',
    size_x: int | Expression = 512,
    size_y: int | Expression = 512,
    radius: float | Expression | None = None,
    obscuration_radius: float | Expression = 25.0,
    slit_width: float | Expression = 20.0,
    vanes: int | Expression = 3,
    vane_width: float | Expression = 4.0,
    path: str | PathLike[str] | None = None,
    wavefront_path: str | PathLike[str] | None = None,
    wavefront_unit: Literal['waves', 'rad', 'um', 'nm'] = 'waves',
    map_wavelength_um: float | Expression | None = None,
    defocus_waves: float | Expression = 0.0,
    zernike_waves: Sequence[float] = (),
) -> Part:
    """Make an exit pupil: 1 transparent, 0 opaque.

    Lengths are in samples, and shapes are centred on the array; Exit Pupil MTF sets the scale.
    `clear` and `half_moon` (x ≥ 0) ignore the obscuration. `hinged` is a disc with an opaque bar
    over the full height. `cassegrain_slit` has the same bar on an annulus; `spider` is an annulus
    with n vanes, 360°/n apart, the first along +x.

    The wavefront error is in waves at the band's middle wavelength, defined on a disc with the
    aperture's radius. For a file, the disc is the smallest circle around all samples above 1 % of
    the largest. The circle is centred on the array if centring increases its radius by at most one
    sample. A `radius` that you enter is always centred on the array. The read-out `aperture_radius`
    gives the radius used. A wavefront map (picture, FITS, `.npy`, text, Zemax listing) is added to
    defocus and Zernike terms. Outside the aperture, the map must be NaN, or 0 all the way to the
    border of the array. Where the map has no value, the pupil is opaque. A map in waves applies at
    its own wavelength; a map in µm is an optical path difference, the same at all wavelengths. A
    complex `.npy` in `path` contains amplitude and phase, valid only at its own wavelength. Row 0
    is at the top. W enters as exp(2πiW), so a W that increases to the right moves the picture to
    the left.
    Sources: Tantalo 1996, section 4.3.2; Noll 1976; Mahajan 1994 (the disc of the wavefront).

    Parameters
    ----------
    shape : Literal['clear', 'half_moon', 'cassegrain', 'hinged', 'cassegrain_slit', 'spider', 'file']
        shape of the aperture: one of clear, half_moon, cassegrain, hinged, cassegrain_slit, spider,
        file; default 'clear'
    size_x : int | Expression
        samples per row of the pupil array: a whole number from 2 to 8192; default 512
    size_y : int | Expression
        samples per column of the pupil array: a whole number from 2 to 8192; default 512
    radius : float | Expression | None
        radius of the aperture; empty: 75, or for a file the radius of the pupil's enclosing circle
        [samples]: a number of at least 0 or empty; default empty
    obscuration_radius : float | Expression
        radius of the central obscuration [samples]: a number of at least 0; default 25.0
    slit_width : float | Expression
        width of the opaque bar [samples]: a number of at least 0; default 20.0
    vanes : int | Expression
        number of vanes: a whole number from 0 to 60; default 3
    vane_width : float | Expression
        width of a vane [samples]: a number of at least 0; default 4.0
    path : str | PathLike[str] | None
        file of the amplitude transmission, or a complex `.npy`, for the shape `file`; empty: 1
        where the wavefront map has a value: a file name or empty; default empty
    wavefront_path : str | PathLike[str] | None
        map of the wavefront error for the shape `file`, relative to the network file's folder: a
        file name or empty; default empty
    wavefront_unit : Literal['waves', 'rad', 'um', 'nm']
        unit of the wavefront map: one of waves, rad, um, nm; default 'waves'
    map_wavelength_um : float | Expression | None
        wavelength of a wavefront map in waves or rad; empty: from the map's header, else the middle
        of the band [µm]: a number of at least 0 or empty; default empty
    defocus_waves : float | Expression
        defocus W20 at the rim of the pupil [waves]: a number from -100 to 100; default 0.0
    zernike_waves : Sequence[float]
        Zernike coefficients in Noll's order, from 1 (piston) [waves rms]: a list of numbers from
        -100 to 100; default ()

    Notes
    -----
    Exit Pupils, in the group Optics.
    Outputs: pupil.
    Read-outs: aperture_radius (samples).
    """

def exit_pupil_mtf(
    *,
    cut_on_um: float | Expression | None = None,
    cut_off_um: float | Expression | None = None,
    size_x_cm: float | Expression = 25.6,
    size_y_cm: float | Expression = 25.6,
    method: Literal['exact', 'autocorrelation'] = 'exact',
    interpolation: Literal['none', 'linear', 'bilinear'] = 'bilinear',
    wavelengths: int | Expression = 1,
    weighting: Literal['uniform', 'photons', 'energy'] = 'uniform',
    source_K: float | Expression | None = None,
    response: str | PathLike[str] | None = None,
    apply: Literal['multiply', 'filter_only'] = 'multiply',
) -> Part:
    """Apply the incoherent OTF of an exit pupil: the pupil's normalised autocorrelation.

    The OTF of a geometric shape is exact, for one wavelength or a band. For pupils from files or
    with wavefront errors, the sampled pupil is autocorrelated. Wavelengths are weighted equally, or
    by the photons or the energy of a black body (`weighting`), and by the detector's `response`.
    The black body's temperature is `source_K`. If `source_K` is empty, the temperature is 5800 K
    (sunlight) for a band that begins below 2.5 µm, and otherwise the brightness temperature of the
    picture's mean radiance. A spectral picture is blurred band by band, each band at its own
    wavelength. With interpolation `none`, the module outputs the raw autocorrelation at the pupil's
    own frequency intervals and does not blur the picture. `size_x_cm` and `size_y_cm` are the
    sizes of the whole pupil array. Source: Tantalo 1996, eqs. 4.10 to 4.21. Erratum: the cutoff is
    aperture/λ. The 12.8 in eq. 4.21 is the array's half width over λ.

    Parameters
    ----------
    cut_on_um : float | Expression | None
        shortest wavelength; empty: from the image's band [µm]: a number of at least 0 or empty;
        default empty
    cut_off_um : float | Expression | None
        longest wavelength; empty: from the image's band [µm]: a number of at least 0 or empty;
        default empty
    size_x_cm : float | Expression
        width of the whole pupil array [cm]: a number above 0; default 25.6
    size_y_cm : float | Expression
        height of the whole pupil array [cm]: a number above 0; default 25.6
    method : Literal['exact', 'autocorrelation']
        exact: closed-form OTF if there is one; autocorrelation: always the sampled pupil's OTF: one
        of exact, autocorrelation; default 'exact'
    interpolation : Literal['none', 'linear', 'bilinear']
        interpolation from the sampled pupil to the image's frequencies: one of none, linear,
        bilinear; default 'bilinear'
    wavelengths : int | Expression
        number of wavelengths that sample the band; 1 uses the band's middle: a whole number from 1
        to 256; default 1
    weighting : Literal['uniform', 'photons', 'energy']
        weighting of the wavelengths: equal (as in Tantalo 1996), by photons, or by energy: one of
        uniform, photons, energy; default 'uniform'
    source_K : float | Expression | None
        temperature of the black body that weights the band; empty: 5800 K if the band begins below
        2.5 µm, else the brightness temperature of the picture's mean [K]: a number from 0 to 1e+06
        or empty; default empty
    response : str | PathLike[str] | None
        CSV file of wavelength (µm) and detector response, which also weights the light; empty:
        equal at all wavelengths: a file name or empty; default empty
    apply : Literal['multiply', 'filter_only']
        multiply the input by the transfer function, or output the transfer function alone: one of
        multiply, filter_only; default 'multiply'

    Notes
    -----
    Exit Pupil MTF, in the group Optics.
    Inputs: context, magnitude, pupil, phase (optional).
    Outputs: magnitude, phase, mtf, ptf.
    Read-outs: mtf_at_nyquist_x, mtf_at_nyquist_y, mtf_at_pixel_nyquist_x, mtf_at_pixel_nyquist_y,
    pupil_interval_x (cyc/mrad), pupil_interval_y (cyc/mrad), image_interval_x (cyc/mrad),
    image_interval_y (cyc/mrad), cutoff_x (cyc/mrad), cutoff_y (cyc/mrad), estimated_error.
    """

def vignetting(
    *,
    natural: bool = True,
    measured: Literal['none', 'file', 'polynomial'] = 'none',
    against: Literal['field_deg', 'height_mm', 'half_diagonal'] = 'field_deg',
    path: str | PathLike[str] | None = None,
    coefficients: Sequence[float] = (),
    focal_length_mm: float | Expression | None = None,
) -> Part:
    """Darken the picture with distance from the optical axis, which is at the picture's middle.

    `natural` applies cos⁴ of the field angle. The tangent of the angle is the distance from the
    middle in samples times the sampling interval, which is pitch/f for a picture from Camera.
    `measured` applies a measured curve of relative illumination: a CSV of height and value
    (`file`), or 1 + c₁h² + c₂h⁴ + … (`polynomial`). `against` selects the height axis: field angle,
    image height, or fraction of the picture's half diagonal. A lens maker's curve usually includes
    cos⁴; in that case, switch `natural` off. Put the module before Focal Plane, so that shot noise
    follows from the vignetted light. Transfer functions do not change. Signal and SNR use the mean
    over the field; NETD and `scene_K` refer to the scene before the vignetting. For a thermal
    picture with one band, Focal Plane converts radiance to photons at the brightness temperature
    that the picture had before the mean loss. A sample with half the mean light then gets 0.3 % too
    many photons (3.7 to 4.8 µm). This error does not occur with spectral pictures, or if
    `photon_weighting` is not scene. Source: Kingslake 1983, Optical System Design, chapter 6.

    Parameters
    ----------
    natural : bool
        apply the natural fall-off, cos⁴ of the field angle: true or false; default True
    measured : Literal['none', 'file', 'polynomial']
        measured relative illumination: one of none, file, polynomial; default 'none'
    against : Literal['field_deg', 'height_mm', 'half_diagonal']
        heights of the curve: field angle, image height, or fraction of the half diagonal: one of
        field_deg, height_mm, half_diagonal; default 'field_deg'
    path : str | PathLike[str] | None
        CSV file of height and relative illumination, 1 on the axis: a file name or empty; default
        empty
    coefficients : Sequence[float]
        c₁, c₂, …: factors of h², h⁴, …: a list of numbers from -1e+09 to 1e+09; default ()
    focal_length_mm : float | Expression | None
        focal length, used if against is height_mm; empty: from Camera [mm]: a number of at least 0
        or empty; default empty

    Notes
    -----
    Vignetting, in the group Optics.
    Inputs: image.
    Outputs: image.
    Read-outs: corner_percent (%), mean_percent (%).
    """

def distortion(
    *,
    model: Literal['brown', 'fisheye'] = 'brown',
    k1: float | Expression = 0.0,
    k2: float | Expression = 0.0,
    k3: float | Expression = 0.0,
    k4: float | Expression = 0.0,
    p1: float | Expression = 0.0,
    p2: float | Expression = 0.0,
    centre_x_mrad: float | Expression = 0.0,
    centre_y_mrad: float | Expression = 0.0,
    width: int | Expression | None = None,
    height: int | Expression | None = None,
) -> Part:
    """Distort the picture like a lens, with Brown–Conrady or fisheye coefficients.

    The incoming picture must be free of distortion: distances from the axis are tangents of field
    angles. Coefficients, centre and signs follow OpenCV, with lengths divided by the focal length.
    `fisheye` with all coefficients at 0 is an f-θ lens. The module traces the ray of each sample
    (to 1e-11 of the focal length) and interpolates the picture there from 8 × 8 samples. Sinusoids
    of up to 0.2 cycles per sample are misplaced by less than 1e-3 sample. The picture is not
    filtered: if `largest_step` is well above 1, sample the scene more finely. A lens with barrel
    distortion images points beyond the frame. Give the scene more samples at the same interval; the
    scene's field of view is samples times interval, not 2·atan(Np/2f) as for a lens. Set `width`
    and `height` to the camera's samples. A warning gives the required sizes. Beyond the scene, the
    outermost samples are repeated. MTF and noise are valid on the axis, where nothing is stretched.
    Sources: Brown 1966; Kannala and Brandt 2006; OpenCV, camera calibration.

    Parameters
    ----------
    model : Literal['brown', 'fisheye']
        model of the distortion, Brown–Conrady or fisheye (f-θ): one of brown, fisheye; default
        'brown'
    k1 : float | Expression
        radial coefficient of r² or θ²: a number from -1e+06 to 1e+06; default 0.0
    k2 : float | Expression
        radial coefficient of r⁴ or θ⁴: a number from -1e+06 to 1e+06; default 0.0
    k3 : float | Expression
        radial coefficient of r⁶ or θ⁶: a number from -1e+06 to 1e+06; default 0.0
    k4 : float | Expression
        radial coefficient of θ⁸: a number from -1e+06 to 1e+06; default 0.0
    p1 : float | Expression
        tangential coefficient: shifts points mostly along y: a number from -1e+06 to 1e+06; default
        0.0
    p2 : float | Expression
        tangential coefficient: shifts points mostly along x: a number from -1e+06 to 1e+06; default
        0.0
    centre_x_mrad : float | Expression
        offset of the optical axis to the right of the picture's middle [mrad]: a number from -10000
        to 10000; default 0.0
    centre_y_mrad : float | Expression
        offset of the optical axis below the picture's middle [mrad]: a number from -10000 to 10000;
        default 0.0
    width : int | Expression | None
        samples per row; empty: unchanged: a whole number from 1 to 65536 or empty; default empty
    height : int | Expression | None
        samples per column; empty: unchanged: a whole number from 1 to 65536 or empty; default empty

    Notes
    -----
    Distortion, in the group Optics.
    Inputs: image.
    Outputs: image.
    Read-outs: corner_percent (%), beyond_percent (%), largest_step (samples).
    """

def field_psf(
    *,
    kind: Literal['gaussian', 'mtf', 'psf'] = 'gaussian',
    positions: Sequence[float] = [0.0, 0.5, 1.0],
    tangential_mrad: Sequence[float] = (),
    sagittal_mrad: Sequence[float] = (),
    path_1: str | PathLike[str] | None = None,
    path_2: str | PathLike[str] | None = None,
    path_3: str | PathLike[str] | None = None,
    path_4: str | PathLike[str] | None = None,
    sample_pitch_um: float | Expression | None = None,
    tile: int | Expression = 64,
) -> Part:
    """Blur the picture by a PSF that changes over the field.

    `positions` are distances from the picture's middle, as fractions of the half diagonal. For each
    position, give a Gaussian or a file that MTF File or PSF File can read. A Gaussian has a
    tangential rms width (along the radius) and a sagittal rms width (across the radius). A file
    gives the MTF or PSF of a point straight above the middle: `mtf_y` is the tangential curve, and
    the top of a PSF's picture points away from the axis. A single Zemax listing in `path_1`
    supplies a field for each position. Between positions, the widths of Gaussians or the OTFs of
    files are interpolated linearly in the square of the position; beyond the last position they
    stay constant. The PSF rotates with the direction of the point from the middle.

    The picture is blurred in overlapping tiles; within a tile, the PSFs of its four corners are
    blended. `error_percent` is an upper limit on the error of any sample, compared with a blur by
    that sample's own PSF, in per cent of the picture's range. In real scenes the error is about ten
    times smaller. Smaller tiles reduce the blending error. Around each tile, the blur uses a
    margin of half a tile, but at least 16 samples. If this margin would lose more than 0.5 % of a
    PSF's light, it is widened, up to 1024 samples. A tile is at least a quarter as wide as its
    margin. Beyond the frame the picture is mirrored, or repeated if Back Transform made it
    periodic. Budgets, MTFs and figures of merit use the PSF of the first position. Source: Nagy and
    O'Leary 1998, SIAM J. Sci. Comput. 19, 1063.

    Parameters
    ----------
    kind : Literal['gaussian', 'mtf', 'psf']
        source of the PSFs: Gaussians, MTF files or PSF files: one of gaussian, mtf, psf; default
        'gaussian'
    positions : Sequence[float]
        positions in ascending order, as fractions of the half diagonal: a list of numbers from 0 to
        10; default [0.0, 0.5, 1.0]
    tangential_mrad : Sequence[float]
        tangential rms width (along the radius), at each position [mrad]: a list of numbers from 0
        to 1e+06; default ()
    sagittal_mrad : Sequence[float]
        sagittal rms width (across the radius); empty: equal to tangential_mrad [mrad]: a list of
        numbers from 0 to 1e+06; default ()
    path_1 : str | PathLike[str] | None
        MTF or PSF file for one position, in the order of `positions`: a file name or empty; default
        empty
    path_2 : str | PathLike[str] | None
        MTF or PSF file for one position, in the order of `positions`: a file name or empty; default
        empty
    path_3 : str | PathLike[str] | None
        MTF or PSF file for one position, in the order of `positions`: a file name or empty; default
        empty
    path_4 : str | PathLike[str] | None
        MTF or PSF file for one position, in the order of `positions`: a file name or empty; default
        empty
    sample_pitch_um : float | Expression | None
        sampling interval of PSF files; empty: from the file [µm]: a number of at least 0 or empty;
        default empty
    tile : int | Expression
        side of a tile [samples]: a whole number from 4 to 2048; default 64

    Notes
    -----
    Field PSF, in the group Optics.
    Inputs: image, context (optional).
    Outputs: image.
    Read-outs: error_percent (%).
    """

def veiling_glare(
    *,
    apply: Literal['multiply', 'filter_only'] = 'multiply',
    form: Literal['length', 'harvey'] = 'length',
    share_percent: float | Expression = 0.0,
    length_mrad: float | Expression = 10.0,
    b_per_sr: float | Expression = 0.0,
    s: float | Expression = -1.5,
    l_mrad: float | Expression = 10.0,
    surfaces: int | Expression = 1,
) -> Part:
    """Spread a share of the light over a wide area, like scatter and ghosts in the lens.

    The point spread function has two parts. A fraction 1 − g of the light is not scattered. The
    fraction g falls off with distance as ℓ/(2π(r² + ℓ²)^(3/2)), with half of this light within
    √3·ℓ. The MTF drops to 1 − g over a few cycles per ℓ: dark areas near bright ones become
    brighter, and fine detail loses a fraction g of its contrast. If g is not known otherwise, enter
    the veiling glare index of the lens, measured as in ISO 9358 in a small black area within an
    evenly bright field. Light that leaves the frame is mirrored or repeated, as Init & Trans
    defines.

    `harvey` models the scatter of optical surfaces instead: BSDF = b·[1 + ((β − β₀)/l)²]^(s/2),
    where β and β₀ are the sines of the angles of the scattered and the direct ray. The total
    integrated scatter (TIS) of a surface, the integral of BSDF·cos θ over the hemisphere, is lost
    from the direct light. Angles refer to the space in front of the lens, at the entrance pupil.
    For an ABg fit enter b = A/B, l = B^(1/g) and s = −g: the two models agree near the direct ray
    and far from it.

    Sources: ISO 9358:1994; Bracewell 2000, The Fourier Transform and Its Applications, table 13
    (Hankel transforms); Harvey and Shack 1978, Applied Optics 17, 3003; Stover 2012, Optical
    Scattering, section 4.5.

    Parameters
    ----------
    apply : Literal['multiply', 'filter_only']
        multiply the input by the transfer function, or output the transfer function alone: one of
        multiply, filter_only; default 'multiply'
    form : Literal['length', 'harvey']
        model of the scatter: share and angular scale, or Harvey's surface scatter: one of length,
        harvey; default 'length'
    share_percent : float | Expression
        share of the light that is scattered [%]: a number from 0 to 100; default 0.0
    length_mrad : float | Expression
        angular scale of the scatter: half of the scattered light falls within 1.73 times it [mrad]:
        a number above 0 to 1e+06; default 10.0
    b_per_sr : float | Expression
        BSDF of a surface at the direct ray [1/sr]: a number from 0 to 1e+12; default 0.0
    s : float | Expression
        slope of the BSDF: exponent of β far from the direct ray: a number from -5 to 0; default
        -1.5
    l_mrad : float | Expression
        shoulder of the BSDF, 1000 times Harvey's l [mrad]: a number from 0.001 to 1000; default
        10.0
    surfaces : int | Expression
        number of scattering surfaces: a whole number from 1 to 1000; default 1

    Notes
    -----
    Veiling Glare, in the group Optics.
    Inputs: context, magnitude.
    Outputs: magnitude, mtf.
    Read-outs: mtf_at_nyquist_x, mtf_at_nyquist_y, mtf_at_pixel_nyquist_x, mtf_at_pixel_nyquist_y,
    scatter_percent (%).
    """

def gaussian_mtf(
    *,
    apply: Literal['multiply', 'filter_only'] = 'multiply',
    sigma_x_mrad: float | Expression = 0.0,
    sigma_y_mrad: float | Expression = 0.0,
) -> Part:
    """Apply a Gaussian blur, for aberrations and other blur that no other module covers.

    The MTF is exp(−2π²(σx²·ξ² + σy²·η²)). Source: Tantalo 1996, eq. 4.22.

    Parameters
    ----------
    apply : Literal['multiply', 'filter_only']
        multiply the input by the transfer function, or output the transfer function alone: one of
        multiply, filter_only; default 'multiply'
    sigma_x_mrad : float | Expression
        horizontal standard deviation of the blur [mrad]: a number of at least 0; default 0.0
    sigma_y_mrad : float | Expression
        vertical standard deviation of the blur [mrad]: a number of at least 0; default 0.0

    Notes
    -----
    Gaussian MTF, in the group Optics.
    Inputs: context, magnitude.
    Outputs: magnitude, mtf.
    Read-outs: mtf_at_nyquist_x, mtf_at_nyquist_y, mtf_at_pixel_nyquist_x, mtf_at_pixel_nyquist_y.
    """

def mtf_file(
    *,
    path: str | PathLike[str] | None = None,
    frequency_unit: Literal['file', 'cyc/mm', 'cyc/mrad', 'cyc/pixel'] = 'file',
    direction: Literal['file', 'x', 'y', 'radial'] = 'file',
    normalise: Literal['refuse', 'at_zero'] = 'refuse',
    field: int | Expression = 0,
    focal_length_mm: float | Expression | None = None,
    detector_x_um: float | Expression | None = None,
    detector_y_um: float | Expression | None = None,
    apply: Literal['multiply', 'filter_only'] = 'multiply',
) -> Part:
    """Apply an MTF from a file: measured, from a data sheet, or from a lens design.

    The file is a CSV table whose first line names its columns. The frequency comes first, with its
    unit, as in `frequency (cyc/mm)`. The next column is `mtf` or `radial`; alternatively, give
    `mtf_x`, `mtf_y` or both. If the phase is known, add `phase`, or `phase_x` and `phase_y`, in rad
    or `(deg)`. Zemax text listings of MTF against frequency are also read; the tangential curve
    acts along y. `direction` sets the axis along which a column `mtf` acts, or selects one of
    several curves; `radial` means the same MTF in all directions. Between points the curve is a
    monotone cubic (PCHIP). A table that begins above frequency 0 gets an MTF of 1 at 0. Beyond the
    last point the MTF is 0; it is never extrapolated. The phase is odd in frequency and is
    interpolated the shorter way round.

    Frequencies are per mm at the focal plane (converted with the focal length), per mrad, or per
    pixel (converted with pitch and focal length). `imagechain measure` writes a table in this
    format from a camera's pictures; the measured MTF includes the pixel. Without a file nothing
    changes. Source: Fritsch and Butland 1984, SIAM J. Sci. Stat. Comput. 5, 300 (interpolation).

    Parameters
    ----------
    path : str | PathLike[str] | None
        CSV table of MTF, relative to the network file's folder; empty: no blur: a file name or
        empty; default empty
    frequency_unit : Literal['file', 'cyc/mm', 'cyc/mrad', 'cyc/pixel']
        unit of the frequencies; `file`: from the file's header line: one of file, cyc/mm, cyc/mrad,
        cyc/pixel; default 'file'
    direction : Literal['file', 'x', 'y', 'radial']
        axis along which the curve acts; `file`: from the name of the curve's column, where the name
        mtf means radial: one of file, x, y, radial; default 'file'
    normalise : Literal['refuse', 'at_zero']
        treatment of an MTF that is not 1 at zero frequency: refuse the file, or divide the MTF by
        its value there: one of refuse, at_zero; default 'refuse'
    field : int | Expression
        field position in a Zemax listing, counted from 0, skipping the diffraction limit: a whole
        number from 0 to 1000; default 0
    focal_length_mm : float | Expression | None
        focal length, for cyc/mm and cyc/pixel; empty: from Init & Trans [mm]: a number of at least
        0 or empty; default empty
    detector_x_um : float | Expression | None
        horizontal pixel pitch, for cyc/pixel; empty: from Init & Trans [µm]: a number of at least 0
        or empty; default empty
    detector_y_um : float | Expression | None
        vertical pixel pitch, for cyc/pixel; empty: from Init & Trans [µm]: a number of at least 0
        or empty; default empty
    apply : Literal['multiply', 'filter_only']
        multiply the input by the transfer function, or output the transfer function alone: one of
        multiply, filter_only; default 'multiply'

    Notes
    -----
    MTF File, in the group Optics.
    Inputs: context, magnitude, phase (optional).
    Outputs: magnitude, phase, mtf, ptf.
    Read-outs: mtf_at_nyquist_x, mtf_at_nyquist_y, mtf_at_pixel_nyquist_x, mtf_at_pixel_nyquist_y,
    end_x (cyc/mrad), end_y (cyc/mrad).
    """

def psf_file(
    *,
    path: str | PathLike[str] | None = None,
    band: int | Expression | None = None,
    sample_pitch: float | Expression | None = None,
    sample_pitch_y: float | Expression | None = None,
    pitch_unit: Literal['um', 'mrad'] = 'um',
    focal_length_mm: float | Expression | None = None,
    centroid: Literal['kept', 'removed'] = 'kept',
    background: float | Expression = 0.0,
    apply: Literal['multiply', 'filter_only'] = 'multiply',
) -> Part:
    """Blur with a point spread function from a file: measured, or from a lens design.

    Every point of the picture is spread into the PSF in the file. Row 0 is at the top, and a tail
    to the right in the file is a tail to the right in the picture. The file may have any format
    that Read Image reads, or be a `.npy` file, a text file or a Zemax listing. The spacing in a
    Zemax listing is used if `sample_pitch` is empty. Samples are divided by their sum. With
    `centroid` kept, the point is at the middle of the file, (n − 1)/2, which lies between samples
    for even sizes. A centroid elsewhere shifts the picture. With `centroid` removed nothing shifts.
    The OTF is the exact sum over the samples at the picture's own frequencies, for any pitch, and 0
    beyond the file's Nyquist frequency. A PSF measured with a detector includes the pixel: leave
    out Detector MTF. Without a file nothing changes. Source: Goodman 2005, Introduction to Fourier
    Optics, section 6.3.

    Parameters
    ----------
    path : str | PathLike[str] | None
        PSF file, relative to the network file's folder; empty: no blur: a file name or empty;
        default empty
    band : int | Expression | None
        band or channel to read, counted from 0: a whole number of at least 0 or empty; default
        empty
    sample_pitch : float | Expression | None
        horizontal sampling interval of the file, in `pitch_unit`; empty: from the file: a number of
        at least 0 or empty; default empty
    sample_pitch_y : float | Expression | None
        vertical sampling interval of the file; empty: equal to sample_pitch: a number of at least 0
        or empty; default empty
    pitch_unit : Literal['um', 'mrad']
        unit of both sampling intervals: µm at the focal plane, or mrad: one of um, mrad; default
        'um'
    focal_length_mm : float | Expression | None
        focal length, used if pitch_unit is um; empty: from Init & Trans [mm]: a number of at least
        0 or empty; default empty
    centroid : Literal['kept', 'removed']
        offset of the centroid from the array's centre: kept (it shifts the picture), or removed:
        one of kept, removed; default 'kept'
    background : float | Expression
        background to subtract from every sample, in the file's unit: a number; default 0.0
    apply : Literal['multiply', 'filter_only']
        multiply the input by the transfer function, or output the transfer function alone: one of
        multiply, filter_only; default 'multiply'

    Notes
    -----
    PSF File, in the group Optics.
    Inputs: context, magnitude, phase (optional).
    Outputs: magnitude, phase, mtf, ptf.
    Read-outs: mtf_at_nyquist_x, mtf_at_nyquist_y, mtf_at_pixel_nyquist_x, mtf_at_pixel_nyquist_y,
    centre_x_mrad (mrad), centre_y_mrad (mrad), sum_of_samples, file_nyquist_x (cyc/mrad).
    """

def crosstrack_mtf(
    *,
    apply: Literal['multiply', 'filter_only'] = 'multiply',
    dwell_time_s: float | Expression = 0.0,
    scan_velocity_mrad_per_s: float | Expression | None = None,
) -> Part:
    """Blur across the track by the scan during one dwell time.

    The MTF is sinc(v·t·ξ). A dwell time of 0 gives no smear. Source: Tantalo 1996, section 4.4.1;
    the thesis neglects this smear.

    Parameters
    ----------
    apply : Literal['multiply', 'filter_only']
        multiply the input by the transfer function, or output the transfer function alone: one of
        multiply, filter_only; default 'multiply'
    dwell_time_s : float | Expression
        dwell time of one sample [s]: a number of at least 0; default 0.0
    scan_velocity_mrad_per_s : float | Expression | None
        scan velocity; empty: from Init & Trans [mrad/s]: a number of at least 0 or empty; default
        empty

    Notes
    -----
    Crosstrack MTF, in the group Motion.
    Inputs: context, magnitude.
    Outputs: magnitude, mtf.
    Read-outs: mtf_at_nyquist_x, mtf_at_nyquist_y, mtf_at_pixel_nyquist_x, mtf_at_pixel_nyquist_y,
    blur_mrad (mrad).
    """

def alongtrack_mtf(
    *,
    apply: Literal['multiply', 'filter_only'] = 'multiply',
    velocity_m_per_s: float | Expression | None = None,
    integration_time_s: float | Expression = 0.0,
    range_m: float | Expression | None = None,
) -> Part:
    """Blur along the track by the platform's forward motion while a sample is collected.

    The MTF is sinc(b·η) with b = velocity·time/range. Source: Tantalo 1996, eqs. 4.24 to 4.28.
    Erratum: the width 134 in eq. 4.28 is in cycles/rad, not cycles/mrad.

    Parameters
    ----------
    apply : Literal['multiply', 'filter_only']
        multiply the input by the transfer function, or output the transfer function alone: one of
        multiply, filter_only; default 'multiply'
    velocity_m_per_s : float | Expression | None
        velocity of the platform; empty: from Init & Trans [m/s]: a number or empty; default empty
    integration_time_s : float | Expression
        integration time [s]: a number of at least 0; default 0.0
    range_m : float | Expression | None
        altitude, or distance to the scene; empty: from Init & Trans [m]: a number of at least 0 or
        empty; default empty

    Notes
    -----
    Alongtrack MTF, in the group Motion.
    Inputs: context, magnitude.
    Outputs: magnitude, mtf.
    Read-outs: mtf_at_nyquist_x, mtf_at_nyquist_y, mtf_at_pixel_nyquist_x, mtf_at_pixel_nyquist_y,
    blur_y_mrad (mrad).
    """

def relative_motion_mtf(
    *,
    apply: Literal['multiply', 'filter_only'] = 'multiply',
    image_velocity_x: float | Expression = 0.0,
    image_velocity_y: float | Expression = 0.0,
    platform_velocity_x: float | Expression = 0.0,
    platform_velocity_y: float | Expression = 0.0,
    integration_time_s: float | Expression = 0.0,
    range_m: float | Expression | None = None,
    model: Literal['published', 'line'] = 'published',
) -> Part:
    """Blur by the relative velocity of platform and image while the detector integrates.

    `published` is the product sinc(bx·ξ)·sinc(by·η), a rectangle (eq. 4.31). `line` is
    sinc(bx·ξ + by·η), the straight smear at constant velocity. A relative velocity of zero gives
    an MTF of exactly 1. Source: Tantalo 1996, eqs. 4.29 to 4.35. Erratum: the widths 160 and 201 in
    eqs. 4.34 and 4.35 are in cycles/rad, not cycles/mrad.

    Parameters
    ----------
    apply : Literal['multiply', 'filter_only']
        multiply the input by the transfer function, or output the transfer function alone: one of
        multiply, filter_only; default 'multiply'
    image_velocity_x : float | Expression
        velocity of the image along x [m/s]: a number; default 0.0
    image_velocity_y : float | Expression
        velocity of the image along y [m/s]: a number; default 0.0
    platform_velocity_x : float | Expression
        velocity of the platform along x [m/s]: a number; default 0.0
    platform_velocity_y : float | Expression
        velocity of the platform along y [m/s]: a number; default 0.0
    integration_time_s : float | Expression
        integration time [s]: a number of at least 0; default 0.0
    range_m : float | Expression | None
        distance to the scene; empty: from Init & Trans [m]: a number of at least 0 or empty;
        default empty
    model : Literal['published', 'line']
        shape of the smear: rectangle (Tantalo's eq. 4.31), or straight line: one of published,
        line; default 'published'

    Notes
    -----
    Relative Motion MTF, in the group Motion.
    Inputs: context, magnitude.
    Outputs: magnitude, mtf.
    Read-outs: mtf_at_nyquist_x, mtf_at_nyquist_y, mtf_at_pixel_nyquist_x, mtf_at_pixel_nyquist_y,
    blur_x_mrad (mrad), blur_y_mrad (mrad).
    """

def jitter_mtf(
    *,
    apply: Literal['multiply', 'filter_only'] = 'multiply',
    sigma_mrad: float | Expression = 0.02,
) -> Part:
    """Blur by random line-of-sight motion within one exposure, with a Gaussian distribution.

    The MTF is exp(−2π²σ²(ξ² + η²)). Source: Tantalo 1996, eq. 4.36, after Pinsky 1991 (typical
    rms motion: 20 to 60 µrad). Erratum: the thesis calls σ² the variance in µrad and gives σ in
    mrad.

    Parameters
    ----------
    apply : Literal['multiply', 'filter_only']
        multiply the input by the transfer function, or output the transfer function alone: one of
        multiply, filter_only; default 'multiply'
    sigma_mrad : float | Expression
        rms line-of-sight motion per axis [mrad]: a number of at least 0; default 0.02

    Notes
    -----
    Jitter MTF, in the group Motion.
    Inputs: context, magnitude.
    Outputs: magnitude, mtf.
    Read-outs: mtf_at_nyquist_x, mtf_at_nyquist_y, mtf_at_pixel_nyquist_x, mtf_at_pixel_nyquist_y,
    half_contrast (cyc/mrad).
    """

def vibration_mtf(
    *,
    apply: Literal['multiply', 'filter_only'] = 'multiply',
    amplitude_x_mrad: float | Expression = 0.0,
    amplitude_y_mrad: float | Expression = 0.0,
    frequency_Hz: float | Expression | None = None,
    integration_time_s: float | Expression | None = None,
) -> Part:
    """Blur by sinusoidal vibration of the line of sight.

    Over a whole number of periods, the MTF is J0(2πA·ξ), where A is the amplitude. A remaining
    part of a period is integrated from phase 0 and weighted by time. Without a frequency or an
    integration time, many periods are assumed. The two axes are independent. Source: Kopeika 1998.

    Parameters
    ----------
    apply : Literal['multiply', 'filter_only']
        multiply the input by the transfer function, or output the transfer function alone: one of
        multiply, filter_only; default 'multiply'
    amplitude_x_mrad : float | Expression
        horizontal amplitude [mrad]: a number of at least 0; default 0.0
    amplitude_y_mrad : float | Expression
        vertical amplitude [mrad]: a number of at least 0; default 0.0
    frequency_Hz : float | Expression | None
        frequency of the vibration [Hz]: a number of at least 0 or empty; default empty
    integration_time_s : float | Expression | None
        integration time [s]: a number of at least 0 or empty; default empty

    Notes
    -----
    Vibration MTF, in the group Motion.
    Inputs: context, magnitude.
    Outputs: magnitude, mtf.
    Read-outs: mtf_at_nyquist_x, mtf_at_nyquist_y, mtf_at_pixel_nyquist_x, mtf_at_pixel_nyquist_y,
    periods (periods).
    """

def line_of_sight(
    *,
    seed_mode: Literal['automatic', 'typed'] = 'automatic',
    seed: int | Expression = 0,
    rms_x_mrad: float | Expression = 0.0,
    rms_y_mrad: float | Expression = 0.0,
    corner_Hz: float | Expression = 5.0,
    psd_path: str | PathLike[str] | None = None,
    integration_time_s: float | Expression = 0.01,
    frame_rate_Hz: float | Expression = 30.0,
    apply: Literal['multiply', 'filter_only'] = 'multiply',
) -> Part:
    """Move the line of sight at random; the motion blurs each exposure and shifts each frame.

    The line-of-sight angle has the power spectral density S = rms²·(2/π)/(corner·(1 +
    (f/corner)²)), or the density in `psd_path` if given; the two axes are independent. Motion about
    the mean position of an exposure gives an MTF, the mean over the exposure of exp(−2π²·v(t)·ξ²).
    The mean position, with spectrum S·sinc²(fT), shifts each frame of a sequence by a phase ramp,
    −2π·ξ·shift. A single picture is frame 0 and is also shifted. 3-D Noise includes the pixel
    changes from this motion in its measurement, but not in its prediction. Sources: Papoulis 1991,
    chapter 10; Kopeika 1998, chapter 14.

    Parameters
    ----------
    seed_mode : Literal['automatic', 'typed']
        derive the seed from the network's seed and this node's name, or enter it in seed: one of
        automatic, typed; default 'automatic'
    seed : int | Expression
        seed, used when seed_mode is typed: a whole number from 0 to 9.22337e+18; default 0
    rms_x_mrad : float | Expression
        horizontal rms motion [mrad]: a number from 0 to 1e+06; default 0.0
    rms_y_mrad : float | Expression
        vertical rms motion [mrad]: a number from 0 to 1e+06; default 0.0
    corner_Hz : float | Expression
        frequency at which the power spectral density has fallen to half its low-frequency value
        [Hz]: a number from 1e-06 to 1e+09; default 5.0
    psd_path : str | PathLike[str] | None
        CSV file of frequency (Hz) and one-sided power spectral density (mrad²/Hz, horizontal and
        vertical); empty: calculated from rms motion and corner frequency: a file name or empty;
        default empty
    integration_time_s : float | Expression
        exposure time [s]: a number from 0 to 1e+06; default 0.01
    frame_rate_Hz : float | Expression
        frame rate [Hz]: a number from 1e-06 to 1e+09; default 30.0
    apply : Literal['multiply', 'filter_only']
        multiply the input by the transfer function, or output the transfer function alone: one of
        multiply, filter_only; default 'multiply'

    Notes
    -----
    Line of Sight, in the group Motion.
    Inputs: context, magnitude, phase.
    Outputs: magnitude, phase, mtf, ptf.
    Read-outs: mtf_at_nyquist_x, mtf_at_nyquist_y, mtf_at_pixel_nyquist_x, mtf_at_pixel_nyquist_y,
    within_x_mrad (mrad), within_y_mrad (mrad), between_x_mrad (mrad), between_y_mrad (mrad),
    shift_x_mrad (mrad), shift_y_mrad (mrad).
    """

def detector_mtf(
    *,
    apply: Literal['multiply', 'filter_only'] = 'multiply',
    detector_x_um: float | Expression | None = None,
    detector_y_um: float | Expression | None = None,
    focal_length_mm: float | Expression | None = None,
    fill_x: float | Expression | None = None,
    fill_y: float | Expression | None = None,
) -> Part:
    """Blur by averaging over the sensitive area of a detector element.

    The MTF is sinc(IFOVx·fill_x·ξ)·sinc(IFOVy·fill_y·η), including its negative lobes. Empty
    parameters are taken from Init & Trans. Source: Tantalo 1996, eqs. 4.41 to 4.50.

    Parameters
    ----------
    apply : Literal['multiply', 'filter_only']
        multiply the input by the transfer function, or output the transfer function alone: one of
        multiply, filter_only; default 'multiply'
    detector_x_um : float | Expression | None
        horizontal detector pitch; empty: from Init & Trans [µm]: a number of at least 0 or empty;
        default empty
    detector_y_um : float | Expression | None
        vertical detector pitch; empty: from Init & Trans [µm]: a number of at least 0 or empty;
        default empty
    focal_length_mm : float | Expression | None
        effective focal length; empty: from Init & Trans [mm]: a number of at least 0 or empty;
        default empty
    fill_x : float | Expression | None
        horizontal fill factor; empty: from Init & Trans: a number from 0 to 1 or empty; default
        empty
    fill_y : float | Expression | None
        vertical fill factor; empty: from Init & Trans: a number from 0 to 1 or empty; default empty

    Notes
    -----
    Detector MTF, in the group Detector.
    Inputs: context, magnitude.
    Outputs: magnitude, mtf.
    Read-outs: mtf_at_nyquist_x, mtf_at_nyquist_y, mtf_at_pixel_nyquist_x, mtf_at_pixel_nyquist_y,
    ifov_x_mrad (mrad), ifov_y_mrad (mrad), first_zero_x (cyc/mrad), first_zero_y (cyc/mrad).
    """

def charge_diffusion_mtf(
    *,
    apply: Literal['multiply', 'filter_only'] = 'multiply',
    depletion_um: float | Expression = 5.0,
    diffusion_length_um: float | Expression = 50.0,
    absorption_per_um: float | Expression | None = None,
    side: Literal['front', 'back'] = 'front',
    thickness_um: float | Expression | None = None,
    cut_on_um: float | Expression | None = None,
    cut_off_um: float | Expression | None = None,
) -> Part:
    """Blur by charge diffusion: carriers generated outside the depletion region diffuse into it.

    With front illumination, the MTF is [1 − e^(−αd)/(1 + αL_f)]/[1 − e^(−αd)/(1 + αL₀)], with L_f =
    L₀/√(1 + (2πL₀f)²). Here, α is the absorption coefficient, d is depletion_um, L₀ is
    diffusion_length_um, and f is the frequency on the detector. For back illumination, the detector
    is assumed to be thinned, with a passivated surface. Most carriers in a back-illuminated
    detector are generated near the back and cross the undepleted silicon (thickness_um minus
    depletion_um). If absorption_per_um is empty, the MTF is averaged from cut_on_um to cut_off_um
    (empty: over the picture's band), for silicon at 295 K. The average assumes the same number of
    photons at all wavelengths and weights each wavelength by the carriers generated. With front
    illumination, red and near-infrared light is blurred most, because it is absorbed deep in the
    silicon. With back illumination, blue light is blurred most. Sources: Seib 1974; Crowell and
    Labuda 1969; Holst and Lomheim 2007, chapter 10; Schinke et al. 2015 (silicon).

    Parameters
    ----------
    apply : Literal['multiply', 'filter_only']
        multiply the input by the transfer function, or output the transfer function alone: one of
        multiply, filter_only; default 'multiply'
    depletion_um : float | Expression
        depth of the depletion region [µm]: a number from 0 to 10000; default 5.0
    diffusion_length_um : float | Expression
        diffusion length outside the depletion region [µm]: a number above 0 to 1e+06; default 50.0
    absorption_per_um : float | Expression | None
        absorption coefficient; empty: computed for silicon over the band [1/µm]: a number from 0 to
        1e+06 or empty; default empty
    side : Literal['front', 'back']
        illuminated side: one of front, back; default 'front'
    thickness_um : float | Expression | None
        thickness of a back-illuminated detector [µm]: a number from 0 to 10000 or empty; default
        empty
    cut_on_um : float | Expression | None
        shortest wavelength; empty: from the image's band [µm]: a number of at least 0 or empty;
        default empty
    cut_off_um : float | Expression | None
        longest wavelength; empty: from the image's band [µm]: a number of at least 0 or empty;
        default empty

    Notes
    -----
    Charge Diffusion MTF, in the group Detector.
    Inputs: context, magnitude.
    Outputs: magnitude, mtf.
    Read-outs: mtf_at_nyquist_x, mtf_at_nyquist_y, mtf_at_pixel_nyquist_x, mtf_at_pixel_nyquist_y,
    mean_absorption_per_um (1/µm).
    """

def crosstalk(
    *,
    kernel: str = '0 0 0; 0 1 0; 0 0 0',
    apply: Literal['multiply', 'filter_only'] = 'multiply',
) -> Part:
    """Blur by crosstalk: each pixel passes a share of its signal to its neighbours.

    The kernel gives the shares of a pixel's signal that stay in the pixel and that leak into each
    neighbour. Enter 3 × 3 or 5 × 5 numbers that add up to 1, with semicolons between the rows. The
    kernel covers optical crosstalk, electrical crosstalk and interpixel capacitance. An asymmetric
    kernel also shifts the picture. To include this shift, connect `phase`. Sources: Holst and
    Lomheim 2007, chapter 10; Moore, Ninkov and Forrest 2006, Optical Engineering 45, 076402
    (interpixel capacitance).

    Parameters
    ----------
    kernel : str
        shares of a pixel's signal that stay or leak, as 3 × 3 or 5 × 5 numbers with semicolons
        between the rows: text; default '0 0 0; 0 1 0; 0 0 0'
    apply : Literal['multiply', 'filter_only']
        multiply the input by the transfer function, or output the transfer function alone: one of
        multiply, filter_only; default 'multiply'

    Notes
    -----
    Crosstalk, in the group Detector.
    Inputs: context, magnitude, phase (optional).
    Outputs: magnitude, phase, mtf, ptf.
    Read-outs: mtf_at_nyquist_x, mtf_at_nyquist_y, mtf_at_pixel_nyquist_x, mtf_at_pixel_nyquist_y,
    crosstalk_percent (%).
    """

def charge_eff_mtf(
    *,
    apply: Literal['multiply', 'filter_only'] = 'multiply',
    detectors_per_line: int | Expression = 640,
    efficiency: float | Expression = 0.99999,
    model: Literal['exact', 'published', 'leading'] = 'exact',
    nyquist: Literal['image', 'detector'] = 'image',
) -> Part:
    """Blur along the read-out direction (x) from incomplete charge transfer.

    With w = 2π·xi·Δ, the MTF is |ε/(1 − (1−ε)e^{−iw})|^N (`exact`) or exp(−N(1−ε)(1 − cos w))
    (`published` and `leading`). Source: Tantalo 1996, eq. 4.57, after LeBlanc and Contini 1990.

    Parameters
    ----------
    apply : Literal['multiply', 'filter_only']
        multiply the input by the transfer function, or output the transfer function alone: one of
        multiply, filter_only; default 'multiply'
    detectors_per_line : int | Expression
        number of transfers: a whole number from 0 to 1e+09; default 640
    efficiency : float | Expression
        charge transfer efficiency: fraction of the charge that each transfer passes on: a number
        from 0 to 1; default 0.99999
    model : Literal['exact', 'published', 'leading']
        exact: product over all transfers; published: eqs. 4.57-4.58 of Tantalo 1996; leading:
        leading term only: one of exact, published, leading; default 'exact'
    nyquist : Literal['image', 'detector']
        distance between charge packets: one image sample, or one detector pitch: one of image,
        detector; default 'image'

    Notes
    -----
    Charge Transfer MTF, in the group Detector.
    Inputs: context, magnitude.
    Outputs: magnitude, mtf.
    Read-outs: mtf_at_nyquist_x, mtf_at_nyquist_y, mtf_at_pixel_nyquist_x, mtf_at_pixel_nyquist_y.
    """

def charge_eff_phase(
    *,
    apply: Literal['multiply', 'filter_only'] = 'multiply',
    detectors_per_line: int | Expression = 640,
    efficiency: float | Expression = 0.99999,
    model: Literal['exact', 'published', 'leading'] = 'exact',
    nyquist: Literal['image', 'detector'] = 'image',
) -> Part:
    """Phase shift along the read-out direction (x) from incomplete charge transfer.

    With w = 2π·xi·Δ and k = N(1−ε), the phase is the argument of [ε/(1 − (1−ε)e^{−iw})]^N
    (`exact`), −k(w − sin w) (`published`) or −k·sin w (`leading`). Source: Tantalo 1996, eq. 4.58.
    Erratum: expanded in w, the published phase starts with a w³ term; for N transfers, it must
    start with −k·w.

    Parameters
    ----------
    apply : Literal['multiply', 'filter_only']
        multiply the input by the transfer function, or output the transfer function alone: one of
        multiply, filter_only; default 'multiply'
    detectors_per_line : int | Expression
        number of transfers: a whole number from 0 to 1e+09; default 640
    efficiency : float | Expression
        charge transfer efficiency: fraction of the charge that each transfer passes on: a number
        from 0 to 1; default 0.99999
    model : Literal['exact', 'published', 'leading']
        exact: product over all transfers; published: eqs. 4.57-4.58 of Tantalo 1996; leading:
        leading term only: one of exact, published, leading; default 'exact'
    nyquist : Literal['image', 'detector']
        distance between charge packets: one image sample, or one detector pitch: one of image,
        detector; default 'image'

    Notes
    -----
    Charge Transfer Phase, in the group Detector.
    Inputs: context, phase.
    Outputs: phase, ptf.
    Read-outs: ptf_at_nyquist_x (rad), ptf_at_pixel_nyquist_x (rad).
    """

def tdi_mtf(
    *,
    apply: Literal['multiply', 'filter_only'] = 'multiply',
    stages: int | Expression = 64,
    phases: int | Expression = 4,
    velocity_mismatch_percent: float | Expression = 0.0,
    line_rate_Hz: float | Expression | None = None,
    yaw_deg: float | Expression = 0.0,
    direction: Literal['y', 'x'] = 'y',
    detector_um: float | Expression | None = None,
    focal_length_mm: float | Expression | None = None,
) -> Part:
    """Blur by time delay and integration: stepwise charge motion and a velocity mismatch.

    With phase measured from the middle of the exposure, the transfer function is sinc((1 +
    m)·s·f)·sin(πNm·s·f)/(N·sin(πm·s·f)). Here, m is the image velocity divided by the charge
    velocity, minus 1; s is the pitch divided by `phases`, and N = stages·phases. With
    `line_rate_Hz`, m follows from the scene's velocity and range (Init & Trans, or Camera's orbit).
    At a yaw ψ, the ratio of image velocity to charge velocity is (1 + m)·cos ψ along the stages and
    (1 + m)·sin ψ across them. Use this module instead of Alongtrack MTF: the step s already
    includes the smear within a stage. With `phases` = 0, the charge moves without steps. Empty
    parameters are taken from Init & Trans. Source: Wong, Yao and Schlig 1992, IBM J. Res. Develop.
    36; Holst and Lomheim 2007, chapter 10.

    Parameters
    ----------
    apply : Literal['multiply', 'filter_only']
        multiply the input by the transfer function, or output the transfer function alone: one of
        multiply, filter_only; default 'multiply'
    stages : int | Expression
        number of stages whose charge is summed: a whole number from 1 to 10000; default 64
    phases : int | Expression
        clock phases per stage: the charge moves once per phase; 0: smooth motion: a whole number
        from 0 to 100; default 4
    velocity_mismatch_percent : float | Expression
        how much faster the image moves than the charge [%]: a number from -99 to 1000; default 0.0
    line_rate_Hz : float | Expression | None
        line rate at which the charge moves; empty: velocity_mismatch_percent is used [Hz]: a number
        of at least 0 or empty; default empty
    yaw_deg : float | Expression
        angle from the stages to the image motion [deg]: a number from -89 to 89; default 0.0
    direction : Literal['y', 'x']
        axis of the motion: vertical (y) or horizontal (x): one of y, x; default 'y'
    detector_um : float | Expression | None
        pitch of the stages; empty: the detector's pitch along the motion [µm]: a number of at least
        0 or empty; default empty
    focal_length_mm : float | Expression | None
        effective focal length [mm]: a number of at least 0 or empty; default empty

    Notes
    -----
    TDI MTF, in the group Detector.
    Inputs: context, magnitude.
    Outputs: magnitude, mtf.
    Read-outs: mtf_at_nyquist_x, mtf_at_nyquist_y, mtf_at_pixel_nyquist_x, mtf_at_pixel_nyquist_y,
    step_mrad (mrad), drift_mrad (mrad), mismatch_percent (%), drift_across_px (px).
    """

def spectral_response(
    *,
    shape: Literal['file', 'rectangle', 'gaussian'] = 'rectangle',
    path: str | PathLike[str] | None = None,
    centre_um: float | Expression | None = None,
    width_um: float | Expression | None = None,
    peak: float | Expression = 1.0,
    source_K: float | Expression | None = None,
) -> Part:
    """Weight every wavelength by the response of a detector material, a filter or a window.

    Each band of a spectral picture is multiplied by the mean response in that band. A Focal Plane
    after this module counts the remaining photons; its NETD refers to the scene before the response
    is applied. The response weights only light from the scene, not radiation from optics and
    housing. A picture with one band is multiplied by the mean response over the band, weighted by
    the radiance of a black body. The temperature of the black body is `source_K`. If `source_K` is
    empty, the temperature is 5800 K (sunlight) for a band that begins below 2.5 µm, and otherwise
    the picture's mean brightness temperature. `file`: a CSV file of wavelength (µm) and response,
    interpolated linearly and 0 outside its points. `gaussian`: `width_um` is the full width at half
    maximum. Enter a response per watt here, without conversion. Enter a response per photon as
    `response` in Focal Plane.

    Parameters
    ----------
    shape : Literal['file', 'rectangle', 'gaussian']
        shape of the spectral response; file: read from the CSV file in path: one of file,
        rectangle, gaussian; default 'rectangle'
    path : str | PathLike[str] | None
        CSV file of wavelength (µm) and response (0 to 1): a file name or empty; default empty
    centre_um : float | Expression | None
        centre wavelength of the response; empty: the middle of the picture's band [µm]: a number
        from 0 to 1000 or empty; default empty
    width_um : float | Expression | None
        width of the response (Gaussian: full width at half maximum); empty: the picture's band
        [µm]: a number from 0 to 1000 or empty; default empty
    peak : float | Expression
        largest response: a number from 0 to 1; default 1.0
    source_K : float | Expression | None
        temperature of the black body that weights a single band; empty: 5800 K if the band begins
        below 2.5 µm, else the brightness temperature of the picture's mean [K]: a number from 0 to
        1e+06 or empty; default empty

    Notes
    -----
    Spectral Response, in the group Detector.
    Inputs: image.
    Outputs: image.
    Read-outs: mean_of_band.
    """

def microlens(
    *,
    chief_ray_deg: float | Expression = 0.0,
    matched_deg: float | Expression = 0.0,
    response: Literal['half_angle', 'file'] = 'half_angle',
    half_response_deg: float | Expression = 20.0,
    path: str | PathLike[str] | None = None,
) -> Part:
    """Darken the picture where the chief ray angle differs from the microlenses' design angle.

    The detector's data sheet gives the chief ray angle (CRA) for which the microlenses at the
    corner are designed. The lens's data sheet gives the CRA of the lens. If the CRAs of lens and
    microlenses are equal, the picture does not change. A difference lowers the response: to half at
    `half_response_deg` or, if `response` is file, according to a measured curve. The optical axis
    is at the middle of the picture, and the corner angles apply at the picture's corners. Only the
    chief ray counts: the response is not averaged over the cone of a fast lens. Put this module
    before Focal Plane, which then computes the shot noise of the darkened picture. Signal and SNR
    use the mean response over the field; transfer functions do not change. Source: Catrysse and
    Wandell 2002, J. Opt. Soc. Am. A 19, 1610.

    Parameters
    ----------
    chief_ray_deg : float | Expression
        chief ray angle of the lens at the corner [deg]: a number from -75 to 75; default 0.0
    matched_deg : float | Expression
        chief ray angle that the microlenses at the corner are designed for [deg]: a number from -75
        to 75; default 0.0
    response : Literal['half_angle', 'file']
        response versus angle: computed from half_response_deg, or a measured curve from a file: one
        of half_angle, file; default 'half_angle'
    half_response_deg : float | Expression
        angle difference at which the response falls to half [deg]: a number from 0.1 to 90; default
        20.0
    path : str | PathLike[str] | None
        CSV file of angle difference (°) and response, which is 1 at 0°: a file name or empty;
        default empty

    Notes
    -----
    Microlens Angle, in the group Detector.
    Inputs: image.
    Outputs: image.
    Read-outs: corner_percent (%), mean_percent (%).
    """

def focal_plane(
    *,
    seed_mode: Literal['automatic', 'typed'] = 'automatic',
    seed: int | Expression = 0,
    integration_time_s: float | Expression = 0.001,
    tdi_stages: int | Expression = 1,
    frames_averaged: int | Expression = 1,
    quantum_efficiency: float | Expression = 0.7,
    quantum_efficiency_percent: float | Expression | None = None,
    responsivity_A_per_W: float | Expression | None = None,
    responsivity_um: float | Expression | None = None,
    response: str | PathLike[str] | None = None,
    cut_on_um: float | Expression | None = None,
    cut_off_um: float | Expression | None = None,
    photon_weighting: Literal['scene', 'source', 'middle'] = 'scene',
    source_K: float | Expression = 5800.0,
    optics_transmission: float | Expression = 1.0,
    optics_K: float | Expression | None = None,
    cold_shield_efficiency: float | Expression = 1.0,
    housing_K: float | Expression | None = None,
    dark_current_e_per_s: float | Expression = 0.0,
    dark_current_A_per_cm2: float | Expression = 0.0,
    dark_reference_K: float | Expression | None = None,
    dark_doubling_K: float | Expression | None = None,
    rule_07: bool = False,
    detector_K: float | Expression | None = None,
    material_cutoff_um: float | Expression | None = None,
    full_well_e: float | Expression | None = None,
    register_well_e: float | Expression | None = None,
    charge_gain: Literal['none', 'photoconductive', 'em_register', 'avalanche'] = 'none',
    charge_gain_factor: float | Expression = 1.0,
    excess_noise_factor: float | Expression | None = None,
    register_stages: int | Expression = 536,
    ionization_ratio: float | Expression = 0.0,
    nonlinearity_percent: float | Expression = 0.0,
    read_noise_e: float | Expression = 0.0,
    prnu_percent: float | Expression = 0.0,
    dsnu_e: float | Expression = 0.0,
    bad_pixel_percent: float | Expression = 0.0,
    binning: Literal['charge', 'digital'] = 'charge',
    binning_x: int | Expression = 1,
    binning_y: int | Expression = 1,
    bits: int | Expression = 0,
    gain_e_per_dn: float | Expression | None = None,
    gain_dB: float | Expression = 0.0,
    offset_dn: float | Expression = 0.0,
    reference_radiance: float | Expression | None = None,
    units: Literal['dn', 'electrons', 'radiance'] = 'dn',
) -> Part:
    """Convert the picture's photons to electrons, add the camera's noise, and digitize the signal.

    The steps, in this order: shot noise of all electrons, drawn for every pixel; PRNU and DSNU,
    which are the same in every frame; nonlinearity, which grows towards the full well; read noise;
    clipping at the full well; gain; offset; rounding to whole numbers. A PRNU of p multiplies all
    electrons, including dark-current electrons, by 1 + p·n, where n is a standard normal deviate;
    EMVA 1288 defines PRNU on the light signal only.

    Give the quantum efficiency as a number, in per cent, in A/W or as a curve over wavelength. On
    Camera, you can give a T-number, which includes the transmission, and choose the sine condition.
    `dark_doubling_K` scales the dark current from `dark_reference_K` to `detector_K`.

    Radiance is converted to photons with the spectrum of a black body at the scene's brightness
    temperature (`scene`) or at `source_K` (`source`), or with the band's middle wavelength
    (`middle`). The table lists the signal for each choice. For a spectral picture, each band is
    converted to photons with the response at its wavelength. A band that begins below 2.5 µm
    is not thermal: there `scene` acts as `source`. NETD, SNR and well fill refer to the picture's
    mean; if the mean is clipped, there is no NETD, SNR or NEI. `snr_at_reference` is the SNR of a
    uniform scene of `reference_radiance`, as specified for Landsat and Sentinel-2.
    `reference_radiance` is the spectral radiance at the aperture, in W/m²/sr/µm, and is constant
    over the band. `frames_averaged` reduces shot and read noise by the square root of the number of
    frames; the average is rounded once. Noise, responsivity and SNR include the nonlinearity;
    signal and well fill count the electrons collected. `saturated` is 1 where the well is full or
    the converter has clipped.

    A charge gain multiplies the electrons after PRNU and DSNU, and adds excess noise. All results
    are in electrons before the charge gain. The values given for read noise, wells and
    gain_e_per_dn refer to electrons after the charge gain; with an EM register, full_well_e refers
    to electrons before the register. Values in amperes include a gain within the pixel, as in a
    QWIP's data sheet; values in e-/s, DSNU and Rule 07 do not. The setting gain_dB is 20·log10 of
    the camera's own gain. The camera's gain divides gain_e_per_dn, so the converter clips at fewer
    electrons.

    Binning sums binning_x × binning_y pixels; all figures then refer to a bin. `charge` sums the
    electrons and reads them once; register_well_e limits the sum. `digital` reads each pixel and
    sums the digital numbers: read noise grows with the square root of the number of pixels, and
    `saturated` is the share of saturated pixels. If `units` is radiance, the value of a bin is the
    mean of its pixels. Binning n pixels multiplies the MTF by sin(πnξΔ)/(n·sin(πξΔ)), where Δ is
    the pixel pitch. Leftover rows and columns are dropped.

    Sources: Dereniak and Boreman 1996; Janesick 2007, Photon Transfer; EMVA 1288 (also doubling of
    the dark current); Tennant et al. 2008 (Rule 07); Levine 1993 (gain of QWIPs); Robbins and
    Hadwen 2003 (EM registers); McIntyre 1966 (avalanches).

    Parameters
    ----------
    seed_mode : Literal['automatic', 'typed']
        derive the seed from the network's seed and this node's name, or enter it in seed: one of
        automatic, typed; default 'automatic'
    seed : int | Expression
        seed, used when seed_mode is typed: a whole number from 0 to 9.22337e+18; default 0
    integration_time_s : float | Expression
        integration time (with TDI: of each stage) [s]: a number above 0 to 10000; default 0.001
    tdi_stages : int | Expression
        number of TDI stages (time delay and integration): a whole number from 1 to 10000; default 1
    frames_averaged : int | Expression
        number of frames averaged: a whole number from 1 to 1e+06; default 1
    quantum_efficiency : float | Expression
        electrons per photon within the band: a number above 0 to 1; default 0.7
    quantum_efficiency_percent : float | Expression | None
        quantum efficiency in per cent; if given, it replaces quantum_efficiency [%]: a number from
        0 to 100 or empty; default empty
    responsivity_A_per_W : float | Expression | None
        current responsivity; if given, it replaces quantum_efficiency [A/W]: a number from 0 to
        1e+06 or empty; default empty
    responsivity_um : float | Expression | None
        wavelength of responsivity_A_per_W; the quantum efficiency at this wavelength is used over
        the whole band [µm]: a number from 0 to 1000 or empty; default empty
    response : str | PathLike[str] | None
        CSV file of wavelength (µm) and quantum efficiency; if given, it replaces
        quantum_efficiency: a file name or empty; default empty
    cut_on_um : float | Expression | None
        shortest wavelength of the cold filter; empty: the image's band [µm]: a number of at least 0
        or empty; default empty
    cut_off_um : float | Expression | None
        longest wavelength of the cold filter; empty: the image's band [µm]: a number of at least 0
        or empty; default empty
    photon_weighting : Literal['scene', 'source', 'middle']
        spectrum used to convert radiance to photons: a black body at the scene's temperature or at
        source_K, or the band's middle wavelength: one of scene, source, middle; default 'scene'
    source_K : float | Expression
        temperature of the light source [K]: a number above 0 to 1e+06; default 5800.0
    optics_transmission : float | Expression
        transmission of the optics, without the obscuration: a number above 0 to 1; default 1.0
    optics_K : float | Expression | None
        temperature of the optics; empty: no emission [K]: a number from 0 to 10000 or empty;
        default empty
    cold_shield_efficiency : float | Expression
        fraction of the housing's radiation that the cold shield blocks: a number from 0 to 1;
        default 1.0
    housing_K : float | Expression | None
        temperature of the housing outside the cold shield; empty: no emission [K]: a number from 0
        to 10000 or empty; default empty
    dark_current_e_per_s : float | Expression
        dark current per pixel [e-/s]: a number from 0 to 1e+15; default 0.0
    dark_current_A_per_cm2 : float | Expression
        dark current per unit of pixel area, instead of dark_current_e_per_s [A/cm²]: a number from
        0 to 1e+06; default 0.0
    dark_reference_K : float | Expression | None
        temperature at which the dark current is given; empty: the detector's temperature [K]: a
        number from 0 to 1000 or empty; default empty
    dark_doubling_K : float | Expression | None
        temperature rise that doubles the dark current; empty: no change with temperature [K]: a
        number from 0 to 1000 or empty; default empty
    rule_07 : bool
        compute the dark current of HgCdTe with Rule 07: true or false; default False
    detector_K : float | Expression | None
        temperature of the detector, for Rule 07 and dark_doubling_K [K]: a number from 0 to 1000 or
        empty; default empty
    material_cutoff_um : float | Expression | None
        cutoff wavelength of the detector material, for Rule 07 [µm]: a number from 0 to 100 or
        empty; default empty
    full_well_e : float | Expression | None
        electrons that a pixel can hold; empty: unlimited [e-]: a number of at least 0 or empty;
        default empty
    register_well_e : float | Expression | None
        electrons that the read-out can hold, after binning and charge gain; empty: unlimited [e-]:
        a number of at least 0 or empty; default empty
    charge_gain : Literal['none', 'photoconductive', 'em_register', 'avalanche']
        gain before the read-out: in a photoconductor (QWIP), an EMCCD register or an avalanche
        diode: one of none, photoconductive, em_register, avalanche; default 'none'
    charge_gain_factor : float | Expression
        mean number of output electrons per input electron: a number above 0 to 100000; default 1.0
    excess_noise_factor : float | Expression | None
        factor by which the charge gain raises the variance of the electrons; empty: computed: a
        number from 1 to 100000 or empty; default empty
    register_stages : int | Expression
        stages of the EM register: a whole number from 1 to 100000; default 536
    ionization_ratio : float | Expression
        k: ratio of the lower to the higher ionization rate; 0: only one type of carrier ionizes: a
        number from 0 to 1; default 0.0
    nonlinearity_percent : float | Expression
        signal loss at the full well, relative to a linear response; the number of electrons lost
        grows with the square of the signal [%]: a number from 0 to 25; default 0.0
    read_noise_e : float | Expression
        read noise [e-]: a number from 0 to 1e+12; default 0.0
    prnu_percent : float | Expression
        PRNU: rms spread of the response between pixels [%]: a number from 0 to 100; default 0.0
    dsnu_e : float | Expression
        DSNU: rms spread of the dark level between pixels [e-]: a number from 0 to 1e+12; default
        0.0
    bad_pixel_percent : float | Expression
        share of dead and hot pixels, some of them clustered [%]: a number from 0 to 100; default
        0.0
    binning : Literal['charge', 'digital']
        quantity that binning sums: the pixels' charge before read noise, or their digital numbers:
        one of charge, digital; default 'charge'
    binning_x : int | Expression
        number of pixels summed horizontally: a whole number from 1 to 1024; default 1
    binning_y : int | Expression
        number of pixels summed vertically: a whole number from 1 to 1024; default 1
    bits : int | Expression
        bits of the converter; 0: no converter [bit]: a whole number from 0 to 24; default 0
    gain_e_per_dn : float | Expression | None
        electrons per digital number; empty: the full well maps to the highest number [e-/DN]: a
        number of at least 0 or empty; default empty
    gain_dB : float | Expression
        gain setting of the camera; 20 dB divides gain_e_per_dn by 10 [dB]: a number from -120 to
        120; default 0.0
    offset_dn : float | Expression
        digital number at zero electrons [DN]: a number from -1.67772e+07 to 1.67772e+07; default
        0.0
    reference_radiance : float | Expression | None
        spectral radiance at which snr_at_reference is computed; empty: no snr_at_reference
        [W/m²/sr/µm]: a number of at least 0 or empty; default empty
    units : Literal['dn', 'electrons', 'radiance']
        unit of the output; with bits above 0, the output is digitized in every unit: one of dn,
        electrons, radiance; default 'dn'

    Notes
    -----
    Focal Plane, in the group Detector.
    Inputs: image, context.
    Outputs: image, electrons, noise, saturated, table.
    Read-outs: signal_e (e-), optics_e (e-), housing_e (e-), dark_e (e-), well_fill_percent (%),
    shot_noise_e (e-), excess_noise_e (e-), read_noise_e (e-), quantization_noise_e (e-),
    temporal_noise_e (e-), fixed_pattern_e (e-), responsivity_e_per_K (e-/K), netd_K (K), snr,
    snr_at_reference, nei_photons_per_cm2 (1/cm²), dynamic_range_dB (dB), emva_dynamic_range_dB
    (dB), sensitivity_threshold_photons (photons), snr_max_dB (dB), gain_e_per_dn (e-/DN), mean_dn
    (DN), photon_weighting, weighting_worth_percent (%), saturated_pixels.
    """

def microbolometer(
    *,
    seed_mode: Literal['automatic', 'typed'] = 'automatic',
    seed: int | Expression = 0,
    netd_mK: float | Expression = 50.0,
    reference_f_number: float | Expression = 1.0,
    reference_transmission: float | Expression = 1.0,
    reference_K: float | Expression = 300.0,
    reference_integration_time_s: float | Expression | None = None,
    f_number: float | Expression | None = None,
    optics_transmission: float | Expression = 1.0,
    integration_time_s: float | Expression | None = None,
    cut_on_um: float | Expression | None = None,
    cut_off_um: float | Expression | None = None,
    time_constant_s: float | Expression = 0.01,
    frame_rate_Hz: float | Expression = 30.0,
    filter_frames: float | Expression = 1.0,
    bits: int | Expression = 0,
    range_low_K: float | Expression | None = None,
    range_high_K: float | Expression | None = None,
    corner_Hz: float | Expression = 0.0,
    longest_period_s: float | Expression = 60.0,
    response_percent: float | Expression = 0.0,
    offset_mK: float | Expression = 0.0,
) -> Part:
    """Add an uncooled detector's thermal lag, and its noise from the data sheet.

    The noise, as scene radiance, is NETD·dL/dT(reference_K)·τ₀Ω₀/(τΩ)·√(t₀/t). Ω₀ (at the F-number
    F₀), τ₀, reference_K and t₀ come from the data sheet; √(t₀/t) applies if both integration times
    are given. For the NETD of a bare detector, set τ₀ = 1. A camera's NETD already includes the
    lens, so enter the lens's F-number and transmission as reference values too. Ω is the projected
    solid angle of the optics, as in Focal Plane. A bolometer's noise does not depend on the scene,
    so the NETD at another background scales as 1/(dL/dT). After one frame, the fraction
    exp(−1/(rate·time constant)) of a change remains, so a changing scene leaves traces in later
    frames. With a scan velocity on Init & Trans, the lag is a low-pass filter along the lines, 1/(1
    + 2πi·τ·v·ξ). At `corner_Hz`, 1/f noise and white noise have the same spectral density.
    Non-uniform gain and offset are the same in every frame; Non-Uniformity Correction removes them.

    The temporal filter averages recursively: y = a·y₋₁ + (1 − a)·x, where a = (n − 1)/(n + 1) and n
    is filter_frames. The filter lowers white noise by a factor of √n and 1/f noise by less, and
    delays changes in the scene. Leave `filter_frames` at 1 if the data sheet's NETD includes the
    filter. Finally, the picture is rounded to 2^bits levels between the radiances of range_low_K
    and range_high_K, and clipped at these two radiances.

    Sources: Kruse 2001, chapters 3 and 4; Rogalski 2011, chapters 4 and 22; Oppenheim and Schafer
    2010, chapter 5 (filter).

    Parameters
    ----------
    seed_mode : Literal['automatic', 'typed']
        derive the seed from the network's seed and this node's name, or enter it in seed: one of
        automatic, typed; default 'automatic'
    seed : int | Expression
        seed, used when seed_mode is typed: a whole number from 0 to 9.22337e+18; default 0
    netd_mK : float | Expression
        NETD from the data sheet [mK]: a number from 0 to 1e+06; default 50.0
    reference_f_number : float | Expression
        F-number at which the NETD was measured: a number from 0.1 to 1000; default 1.0
    reference_transmission : float | Expression
        transmission of the optics used when the NETD was measured; 1: a bare detector: a number
        above 0 to 1; default 1.0
    reference_K : float | Expression
        background temperature at which the NETD was measured [K]: a number from 1 to 10000; default
        300.0
    reference_integration_time_s : float | Expression | None
        integration time at which the NETD was measured; leave both integration times empty if they
        are equal [s]: a number from 0 to 1000 or empty; default empty
    f_number : float | Expression | None
        F-number of the camera; empty: from Init & Trans: a number from 0.1 to 1000 or empty;
        default empty
    optics_transmission : float | Expression
        transmission of the optics, without the obscuration: a number above 0 to 1; default 1.0
    integration_time_s : float | Expression | None
        integration time of the camera; leave both integration times empty if they are equal [s]: a
        number from 0 to 1000 or empty; default empty
    cut_on_um : float | Expression | None
        shortest wavelength; empty: from the image's band [µm]: a number of at least 0 or empty;
        default empty
    cut_off_um : float | Expression | None
        longest wavelength; empty: from the image's band [µm]: a number of at least 0 or empty;
        default empty
    time_constant_s : float | Expression
        thermal time constant [s]: a number from 0 to 1000; default 0.01
    frame_rate_Hz : float | Expression
        frame rate [Hz]: a number from 1e-06 to 1e+09; default 30.0
    filter_frames : float | Expression
        temporal filter: lowers white noise as much as averaging this many frames; 1: no filter: a
        number from 1 to 16; default 1.0
    bits : int | Expression
        bits of the output; 0: no rounding [bit]: a whole number from 0 to 24; default 0
    range_low_K : float | Expression | None
        scene temperature at the lowest digital number; needed if bits is above 0 [K]: a number from
        0 to 10000 or empty; default empty
    range_high_K : float | Expression | None
        scene temperature at the highest digital number; needed if bits is above 0 [K]: a number
        from 0 to 10000 or empty; default empty
    corner_Hz : float | Expression
        corner frequency, where 1/f and white noise have equal spectral density; 0: no 1/f noise
        [Hz]: a number from 0 to 1e+09; default 0.0
    longest_period_s : float | Expression
        longest period of the 1/f noise: time since the last correction [s]: a number from 1e-09 to
        1e+09; default 60.0
    response_percent : float | Expression
        PRNU: rms spread of the response between pixels [%]: a number from 0 to 100; default 0.0
    offset_mK : float | Expression
        rms spread of the offset between pixels, at the data sheet's background [mK]: a number from
        0 to 1e+09; default 0.0

    Notes
    -----
    Microbolometer, in the group Detector.
    Inputs: image, context.
    Outputs: image, noise, mtf, ptf, table.
    Read-outs: netd_K (K), white_netd_K (K), flicker_K (K), quantization_K (K), fixed_pattern_K (K),
    noise_radiance (W/m²/sr), snr, scene_K (K), lag_percent (%).
    """

def nuc(
    *,
    seed_mode: Literal['automatic', 'typed'] = 'automatic',
    seed: int | Expression = 0,
    method: Literal['none', 'one_point', 'two_point'] = 'two_point',
    low_K: float | Expression = 290.0,
    high_K: float | Expression = 310.0,
    reference_frames: int | Expression = 16,
    drift_K: float | Expression = 0.0,
) -> Part:
    """Correct pixel non-uniformity with uniform references at one or two temperatures.

    Put this module after the camera's modules. A black body that fills the field of view replaces
    the input of the first module that adds noise. The picture of the black body is averaged over
    `reference_frames` frames, each with its own noise; the same average corrects every frame.
    `one_point`: the pattern at `low_K` is subtracted; the residual grows with the scene's
    temperature difference from `low_K`, because the gains differ. `two_point`: gain and offset come
    from a straight line through both references; the residual comes from the noise of the averaged
    references and from nonlinearity. `drift_K` adds the offset drift since the correction: the rms
    over the pixels, expressed as a scene temperature. A pixel with less than a tenth of the mean
    response gets a gain of 1. The frames of a reference share their 1/f noise, but budgets treat
    this noise as independent from frame to frame. Sources: Perry and Dereniak 1993; Schulz and
    Caldwell 1995; Holst 2008.

    Parameters
    ----------
    seed_mode : Literal['automatic', 'typed']
        derive the seed from the network's seed and this node's name, or enter it in seed: one of
        automatic, typed; default 'automatic'
    seed : int | Expression
        seed, used when seed_mode is typed: a whole number from 0 to 9.22337e+18; default 0
    method : Literal['none', 'one_point', 'two_point']
        number of reference sources: none, one or two: one of none, one_point, two_point; default
        'two_point'
    low_K : float | Expression
        temperature of the reference, or of the cooler one if there are two [K]: a number from 1 to
        10000; default 290.0
    high_K : float | Expression
        temperature of the warmer reference [K]: a number from 1 to 10000; default 310.0
    reference_frames : int | Expression
        number of reference frames averaged: a whole number from 1 to 100000; default 16
    drift_K : float | Expression
        offset drift since the correction: rms over the pixels, as a scene temperature [K]: a number
        from 0 to 10000; default 0.0

    Notes
    -----
    Non-Uniformity Correction, in the group Detector.
    Inputs: image.
    Outputs: image, gain, offset, table.
    Read-outs: pattern_low, pattern_high, response_per_kelvin, weak_pixels.
    """

def dual_gain(
    *,
    switch_level: float | Expression | None = None,
    blend_percent: float | Expression = 0.0,
    low_factor: float | Expression = 1.0,
) -> Part:
    """Combine two read-outs of one scene: high gain for dark areas, low gain for bright areas.

    Use this module for pixels that are read at two gains, or for HDR from a long and a short
    exposure. Give each read-out its own Focal Plane, with `units` = electrons. Pixels of `image`
    come from `high` up to `switch_level`, and from `low` above this level. For two gains of one
    exposure, enter the same seed on both Focal Planes, so that they share shot noise and fixed
    pattern. For two exposures, set `low_factor` to the ratio of the exposure times. Connect both
    tables to get the combined dynamic range, and a warning if `low_factor` does not match the
    tables. Focal Plane warns if the high gain clips; this is expected. Noise budgets and figures of
    merit use the noise of `high`, which is the noise of the picture up to `switch_level`. Source:
    EMVA 1288 release 4.0 (dynamic range: saturation over dark noise), applied to the two read-outs.

    Parameters
    ----------
    switch_level : float | Expression | None
        sample value in the `high` picture, in its unit, above which the `low` picture is used;
        empty: `low` is never used: a number from 1e-12 to 1e+12 or empty; default empty
    blend_percent : float | Expression
        width of the transition below switch_level, as a share of switch_level [%]: a number from 0
        to 100; default 0.0
    low_factor : float | Expression
        factor that scales low to the level of high: ratio of the exposure times, or of the gains in
        DN: a number from 1e-06 to 1e+06; default 1.0

    Notes
    -----
    Dual Gain, in the group Detector.
    Inputs: high, low, high_table (optional), low_table (optional).
    Outputs: image, low_share.
    Read-outs: low_percent (%), dynamic_range_dB (dB).
    """

def read_window(
    *,
    columns: int | Expression | None = None,
    rows: int | Expression | None = None,
    left: int | Expression | None = None,
    top: int | Expression | None = None,
    row_time_us: float | Expression | None = None,
    overhead_us: float | Expression = 0.0,
) -> Part:
    """Read a window of the detector, the region of interest (ROI), and drop all other pixels.

    An empty offset centres the window. Put this module after Focal Plane or Microbolometer: the
    pixels keep their noise and their fixed pattern, whatever the window. Transfer functions, NETD
    and SNR do not change. Fewer rows are read faster: `frame_rate_Hz` is the highest rate of a
    detector that reads row by row, with an overhead for each frame. Source: EMVA 1288 release 4.0,
    section 2 (region of interest); the frame rate follows from the row time on the data sheet.

    Parameters
    ----------
    columns : int | Expression | None
        width of the window; empty: all columns [px]: a whole number from 1 to 65536 or empty;
        default empty
    rows : int | Expression | None
        height of the window; empty: all rows [px]: a whole number from 1 to 65536 or empty; default
        empty
    left : int | Expression | None
        columns to the left of the window; empty: centred [px]: a whole number from 0 to 65535 or
        empty; default empty
    top : int | Expression | None
        rows above the window; empty: centred [px]: a whole number from 0 to 65535 or empty; default
        empty
    row_time_us : float | Expression | None
        time to read one row [µs]: a number from 1e-06 to 1e+09 or empty; default empty
    overhead_us : float | Expression
        time that each frame takes in addition to reading its rows [µs]: a number from 0 to 1e+09;
        default 0.0

    Notes
    -----
    Read-out Window, in the group Detector.
    Inputs: image.
    Outputs: image.
    Read-outs: frame_rate_Hz (Hz).
    """

def rolling_shutter(
    *,
    image_velocity_x: float | Expression = 0.0,
    image_velocity_y: float | Expression = 0.0,
    line_time_s: float | Expression = 2e-05,
) -> Part:
    """Skew and stretch the picture: lines are exposed in turn while the image moves.

    The top line is exposed first. Velocities refer to the image on the detector, in pixels per
    second. Put this module before Sample Pixels or Combine Pixels: all samples of a line of pixels
    are exposed together. Put modules that add noise after Rolling Shutter. A windowed sinc
    interpolates between samples. Detail above 70 % of the samples' Nyquist frequency loses
    contrast, and sharp edges show ringing. Beyond its edges, the frame is extended as in
    Interpolate. Use Relative Motion MTF for the blur within one exposure. Predicted MTFs and
    budgets assume an image at rest. Source: Liang, Chang and Chen 2008, IEEE Transactions on Image
    Processing 17, 1323.

    Parameters
    ----------
    image_velocity_x : float | Expression
        velocity of the image to the right [px/s]: a number from -1e+06 to 1e+06; default 0.0
    image_velocity_y : float | Expression
        velocity of the image downwards [px/s]: a number from -1e+06 to 1e+06; default 0.0
    line_time_s : float | Expression
        time from one line to the next [s]: a number from 0 to 1; default 2e-05

    Notes
    -----
    Rolling Shutter, in the group Detector.
    Inputs: image.
    Outputs: image.
    Read-outs: skew_px (px).
    """

def frame_transfer_smear(
    *,
    line_transfer_time_s: float | Expression = 0.0,
    integration_time_s: float | Expression = 0.01,
    passed: Literal['both', 'above', 'below'] = 'both',
) -> Part:
    """Smear bright objects along their columns, as a frame-transfer CCD without a shutter does.

    A charge packet spends one line transfer time in every row that it passes through. After the
    exposure, the packet passes the rows between its pixel and the storage area; before the
    exposure, it passed the other rows. If the detector is cleared just before the exposure, set
    `passed` to the side of the storage area. Put this module after Sample Pixels or Combine Pixels
    and before Focal Plane, which then adds the shot noise of the smear. Source: Janesick 2001,
    Scientific Charge-Coupled Devices, chapter 1.

    Parameters
    ----------
    line_transfer_time_s : float | Expression
        time to transfer one line [s]: a number from 0 to 1; default 0.0
    integration_time_s : float | Expression
        exposure time; enter integration_time_s of Focal Plane [s]: a number from 1e-09 to 1e+06;
        default 0.01
    passed : Literal['both', 'above', 'below']
        illuminated rows that a charge packet passes: on both sides of its pixel, only above or only
        below: one of both, above, below; default 'both'

    Notes
    -----
    Frame Transfer Smear, in the group Detector.
    Inputs: image.
    Outputs: image.
    Read-outs: smear_percent (%).
    """

def blooming(
    *,
    full_well: float | Expression | None = None,
    anti_blooming_percent: float | Expression = 0.0,
) -> Part:
    """Spill charge above the full well along the column.

    A full pixel passes its excess to the pixels above and below, half to each, until no pixel holds
    more than its full well. Charge that reaches the top or bottom edge leaves the detector. The
    anti-blooming drain removes its share of the excess first. The picture may be in any unit
    proportional to electrons. Put this module after Sample Pixels or Combine Pixels and before
    Focal Plane. Before Focal Plane, the full well is a radiance: saturation_radiance in Focal
    Plane's table. Predicted MTFs and budgets ignore blooming. Sources: Janesick 2001, Scientific
    Charge-Coupled Devices, chapter 4; Levine and Peres 2009, Potential Analysis 30, 1.

    Parameters
    ----------
    full_well : float | Expression | None
        sample value of a full pixel, in the picture's unit: W/m²/sr before Focal Plane, not
        electrons; empty: no blooming: a number from 1e-12 to 1e+12 or empty; default empty
    anti_blooming_percent : float | Expression
        share of the excess that the anti-blooming drain removes [%]: a number from 0 to 100;
        default 0.0

    Notes
    -----
    Blooming, in the group Detector.
    Inputs: image.
    Outputs: image.
    """

def charge_trails(
    *,
    serial_efficiency: float | Expression = 1.0,
    parallel_efficiency: float | Expression = 1.0,
    amplifier: Literal['bottom_left', 'bottom_right', 'top_left', 'top_right'] = 'bottom_left',
    extra_serial: int | Expression = 0,
    extra_parallel: int | Expression = 0,
) -> Part:
    """Add the trails of incomplete charge transfer, which grow with distance from the amplifier.

    In each transfer, a share of the charge stays behind and joins the next packet. Charge is
    shifted along the columns into the serial register, which is then read pixel by pixel. A pixel
    that is n transfers away from the amplifier loses about n·(1 − efficiency) of its charge to its
    trail. Charge that trails out of the picture is lost. Use either this module or Charge Transfer
    MTF, which blurs all pixels equally. Put this module after Sample Pixels or Combine Pixels.
    Predicted MTFs hold for the middle pixel. Source: Janesick 2001, Scientific Charge-Coupled
    Devices, chapter 5.

    Parameters
    ----------
    serial_efficiency : float | Expression
        serial charge transfer efficiency, per transfer along a row: a number from 0.5 to 1; default
        1.0
    parallel_efficiency : float | Expression
        parallel charge transfer efficiency, per transfer along a column: a number from 0.5 to 1;
        default 1.0
    amplifier : Literal['bottom_left', 'bottom_right', 'top_left', 'top_right']
        corner where the amplifier is: one of bottom_left, bottom_right, top_left, top_right;
        default 'bottom_left'
    extra_serial : int | Expression
        extra transfers along a row, outside the picture: a whole number from 0 to 1e+06; default 0
    extra_parallel : int | Expression
        extra transfers along a column, outside the picture: a whole number from 0 to 1e+06; default
        0

    Notes
    -----
    Charge Trails, in the group Detector.
    Inputs: image.
    Outputs: image.
    Read-outs: trail_percent (%).
    """

def persistence(
    *,
    fast_percent: float | Expression = 0.0,
    fast_time_constant_s: float | Expression = 1.0,
    slow_percent: float | Expression = 0.0,
    slow_time_constant_s: float | Expression = 100.0,
    delay_s: float | Expression = 0.0,
) -> Part:
    """Add image lag: a remnant of an earlier exposure that decays with two time constants.

    Connect the picture of the earlier exposure to `earlier`; both pictures must have the same size
    and unit. The shares fast_percent and slow_percent refer to the end of the earlier exposure.
    Budgets treat the lag as a fixed pattern. Source: Smith, Zavodny, Rahmer and Bonati 2008,
    Proceedings of SPIE 7021, 70210J (infrared detectors).

    Parameters
    ----------
    fast_percent : float | Expression
        share of the earlier picture that decays fast [%]: a number from 0 to 100; default 0.0
    fast_time_constant_s : float | Expression
        time constant of the fast share [s]: a number from 1e-09 to 1e+09; default 1.0
    slow_percent : float | Expression
        share of the earlier picture that decays slowly [%]: a number from 0 to 100; default 0.0
    slow_time_constant_s : float | Expression
        time constant of the slow share [s]: a number from 1e-09 to 1e+09; default 100.0
    delay_s : float | Expression
        time since the earlier exposure [s]: a number from 0 to 1e+09; default 0.0

    Notes
    -----
    Persistence, in the group Detector.
    Inputs: image, earlier.
    Outputs: image.
    Read-outs: lag_percent (%).
    """

def poisson_noise(
    *,
    seed_mode: Literal['automatic', 'typed'] = 'automatic',
    seed: int | Expression = 0,
    width_px: float | Expression = 5.0,
    percent: float | Expression = 1.0,
    photons_per_unit: float | Expression | None = None,
    mode: Literal['published', 'photon'] = 'published',
) -> Part:
    """Add photon noise to the picture, with the 1996 model or by counting photons.

    `published` adds a Poisson deviate whose mean is a percentage of the Gaussian-weighted local
    mean. `photon` converts radiance to a number of photons and replaces that number with a Poisson
    deviate. The 1996 model has no photon scale, so its relative noise changes with the radiance
    unit. The 1996 model also adds the noise before the optics have collected the light. For the
    shot noise of a detector, use Focal Plane. Source: Tantalo 1996, section 4.3.4, after Frieden
    1991.

    Parameters
    ----------
    seed_mode : Literal['automatic', 'typed']
        derive the seed from the network's seed and this node's name, or enter it in seed: one of
        automatic, typed; default 'automatic'
    seed : int | Expression
        seed, used when seed_mode is typed: a whole number from 0 to 9.22337e+18; default 0
    width_px : float | Expression
        standard deviation of the Gaussian that weights the local mean [px]: a number of at least 0;
        default 5.0
    percent : float | Expression
        mean of the Poisson deviate, as a fraction of the local mean [%]: a number of at least 0;
        default 1.0
    photons_per_unit : float | Expression | None
        photons per unit of radiance; needed if mode is photon: a number of at least 0 or empty;
        default empty
    mode : Literal['published', 'photon']
        published: add a Poisson deviate to each sample; photon: replace each sample with a Poisson
        deviate: one of published, photon; default 'published'

    Notes
    -----
    Poisson Noise, in the group Electronics & Noise.
    Inputs: image.
    Outputs: image, noise.
    Read-outs: noise_mean, noise_sigma.
    """

def electronics_noise(
    *,
    seed_mode: Literal['automatic', 'typed'] = 'automatic',
    seed: int | Expression = 0,
    cut_on_um: float | Expression | None = None,
    cut_off_um: float | Expression | None = None,
    region: Literal['VIS', 'MWIR', 'LWIR'] = 'VIS',
    material: Literal['HgCdTe', 'InSb', 'PtSi', 'Si', 'Si:Ga', 'Si:As', 'manual'] = 'HgCdTe',
    d_star: float | Expression | None = None,
    optics_transmission: float | Expression = 1.0,
    filter_transmission: float | Expression = 1.0,
    scan_mirror_rate_Hz: float | Expression | None = None,
    time_constant_s: float | Expression | None = None,
    bandwidth_Hz: float | Expression | None = None,
    amplifier_snr: float | Expression | None = None,
    snr_reference: Literal['mean', 'contrast'] = 'mean',
    gain_percent: float | Expression = 0.0,
    bias_percent: float | Expression = 0.0,
    gain_model: Literal['per_pixel', 'published', 'literal'] = 'per_pixel',
    noise_variability_percent: float | Expression = 0.0,
    use_mtf: bool = False,
    post_filter: Literal['none', 'lowpass', 'highpass', 'boost'] = 'none',
    post_corner_Hz: float | Expression | None = None,
    post_poles: int | Expression = 1,
    post_gain: float | Expression = 2.0,
    bits: Literal[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24, 32, 64] = 0,
    range_low: float | Expression | None = None,
    range_high: float | Expression | None = None,
    background_K: float | Expression | None = None,
) -> Part:
    """Simulate read-out electronics: gain and bias, detector and amplifier noise, quantization.

    The first steps are gain and bias errors of each detector, and detector noise, whose rms is NER.
    Then the pre-amplifier's single pole, 1/(1 + 2πi·τ·v·ξ), filters along the scan. The last steps
    are amplifier noise, whose rms is reference/SNR, a post filter and quantization. NEP and NER
    refer to a detector with mean noise. NETD and SNR use the rms noise over all detectors, which is
    √(1 + v²) times the mean noise for a relative spread v. Sources: Tantalo 1996, sections 4.6,
    4.7, 4.9 and 4.10. Erratum: eq. 4.59 as printed scales the picture by the gain error
    (`literal`).

    Parameters
    ----------
    seed_mode : Literal['automatic', 'typed']
        derive the seed from the network's seed and this node's name, or enter it in seed: one of
        automatic, typed; default 'automatic'
    seed : int | Expression
        seed, used when seed_mode is typed: a whole number from 0 to 9.22337e+18; default 0
    cut_on_um : float | Expression | None
        shortest wavelength; empty: from the image's band [µm]: a number of at least 0 or empty;
        default empty
    cut_off_um : float | Expression | None
        longest wavelength; empty: from the image's band [µm]: a number of at least 0 or empty;
        default empty
    region : Literal['VIS', 'MWIR', 'LWIR']
        wavelength region: one of VIS, MWIR, LWIR; default 'VIS'
    material : Literal['HgCdTe', 'InSb', 'PtSi', 'Si', 'Si:Ga', 'Si:As', 'manual']
        detector material, for D*: one of HgCdTe, InSb, PtSi, Si, Si:Ga, Si:As, manual; default
        'HgCdTe'
    d_star : float | Expression | None
        D*, used instead of the material's D* [cm √Hz/W]: a number of at least 0 or empty; default
        empty
    optics_transmission : float | Expression
        transmission of the optics, without the obscuration: a number above 0 to 1; default 1.0
    filter_transmission : float | Expression
        transmission of the optical filter: a number above 0 to 1; default 1.0
    scan_mirror_rate_Hz : float | Expression | None
        rotation rate of the scan mirror; empty: scan velocity from Init & Trans [Hz]: a number of
        at least 0 or empty; default empty
    time_constant_s : float | Expression | None
        detector time constant; empty: the dwell time [s]: a number of at least 0 or empty; default
        empty
    bandwidth_Hz : float | Expression | None
        noise bandwidth; empty: 1/(2τ) [Hz]: a number of at least 0 or empty; default empty
    amplifier_snr : float | Expression | None
        SNR of the amplifier; empty: no amplifier noise: a number of at least 0 or empty; default
        empty
    snr_reference : Literal['mean', 'contrast']
        signal to which amplifier_snr refers: the picture's mean, or its maximum minus its minimum:
        one of mean, contrast; default 'mean'
    gain_percent : float | Expression
        rms spread of the gain between detectors, relative to the mean gain [%]: a number of at
        least 0; default 0.0
    bias_percent : float | Expression
        rms spread of the bias between detectors, relative to the picture's mean [%]: a number of at
        least 0; default 0.0
    gain_model : Literal['per_pixel', 'published', 'literal']
        gain errors: per_pixel scales each pixel; published adds a fraction of the picture's mean;
        literal uses Tantalo's eq. 4.59 as printed: one of per_pixel, published, literal; default
        'per_pixel'
    noise_variability_percent : float | Expression
        rms spread of the noise level between detectors, relative to its mean [%]: a number of at
        least 0; default 0.0
    use_mtf : bool
        apply the pre-amplifier's MTF and PTF: true or false; default False
    post_filter : Literal['none', 'lowpass', 'highpass', 'boost']
        filter after the amplifier: one of none, lowpass, highpass, boost; default 'none'
    post_corner_Hz : float | Expression | None
        corner frequency of the low-pass or high-pass filter, or frequency at which the boost
        reaches post_gain [Hz]: a number of at least 0 or empty; default empty
    post_poles : int | Expression
        number of poles of the post filter: a whole number from 1 to 100; default 1
    post_gain : float | Expression
        gain of the boost at post_corner_Hz and above: a number from 1 to 1e+06; default 2.0
    bits : Literal[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24, 32, 64]
        bits per pixel; 0: no quantization [bit]: one of 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12,
        13, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24, 32, 64; default 0
    range_low : float | Expression | None
        lowest level of the quantizer; empty: the picture's minimum [W/m²/sr]: a number or empty;
        default empty
    range_high : float | Expression | None
        highest level of the quantizer; empty: the picture's maximum [W/m²/sr]: a number or empty;
        default empty
    background_K : float | Expression | None
        background temperature; empty: brightness temperature of the picture's mean [K]: a number of
        at least 0 or empty; default empty

    Notes
    -----
    Electronics & Noise, in the group Electronics & Noise.
    Inputs: image, context.
    Outputs: image, noise, detector_noise, quantization_error, mtf, ptf, table.
    Read-outs: bandwidth_Hz (Hz), g_number (1/sr), d_star (cm √Hz/W), nep_W (W), ner (W/m²/sr),
    netd_detector_K (K), netd_amplifier_K (K), netd_system_K (K), snr, quantization_rms (W/m²/sr),
    background_K (K).
    """

def periodic_noise(
    *,
    amplitude: float | Expression = 0.0,
    xi: float | Expression = 0.1,
    eta: float | Expression = 0.0,
    phase_deg: float | Expression = 0.0,
    modulation: float | Expression = 0.0,
    modulation_xi: float | Expression = 0.01,
    modulation_eta: float | Expression = 0.0,
    modulation_phase_deg: float | Expression = 0.0,
) -> Part:
    """Add sinusoidal noise, such as pick-up from a power supply, optionally modulated in amplitude.

    The noise is amplitude·(1 + modulation·sin(2π(ξₘx + ηₘy) + φₘ))·sin(2π(ξx + ηy) + φ). The
    coordinates x and y are 0 at the first sample. Frequencies beyond Nyquist are aliased. An
    amplitude of 0 changes nothing. Source: Tantalo 1996, chapter 3.

    Parameters
    ----------
    amplitude : float | Expression
        amplitude, in the picture's unit: a number; default 0.0
    xi : float | Expression
        horizontal frequency [cyc/mrad]: a number; default 0.1
    eta : float | Expression
        vertical frequency [cyc/mrad]: a number; default 0.0
    phase_deg : float | Expression
        phase at the first sample [deg]: a number; default 0.0
    modulation : float | Expression
        modulation depth: a number from 0 to 1; default 0.0
    modulation_xi : float | Expression
        horizontal frequency of the modulation [cyc/mrad]: a number; default 0.01
    modulation_eta : float | Expression
        vertical frequency of the modulation [cyc/mrad]: a number; default 0.0
    modulation_phase_deg : float | Expression
        phase of the modulation at the first sample [deg]: a number; default 0.0

    Notes
    -----
    Periodic Noise, in the group Electronics & Noise.
    Inputs: image.
    Outputs: image, noise.
    """

def noise_file(
    *,
    path: str | PathLike[str] | None = None,
    band: int | Expression = 0,
    scale: float | Expression = 1.0,
) -> Part:
    """Add noise from a file, times `scale`, to a picture of the same size.

    The file may have any format that Read Image reads. The mean of the noise is added too. A scale
    of 0 changes nothing. Source: Tantalo 1996, chapter 3.

    Parameters
    ----------
    path : str | PathLike[str] | None
        noise file, relative to the network file's folder: a file name or empty; default empty
    band : int | Expression
        band or channel to read, counted from 0: a whole number of at least 0; default 0
    scale : float | Expression
        factor that converts the file to the picture's unit: a number; default 1.0

    Notes
    -----
    Noise File, in the group Electronics & Noise.
    Inputs: image.
    Outputs: image, noise.
    """

def noise_3d_source(
    *,
    seed_mode: Literal['automatic', 'typed'] = 'automatic',
    seed: int | Expression = 0,
    sigma_tvh: float | Expression = 0.0,
    sigma_tv: float | Expression = 0.0,
    sigma_th: float | Expression = 0.0,
    sigma_t: float | Expression = 0.0,
    sigma_vh: float | Expression = 0.0,
    sigma_v: float | Expression = 0.0,
    sigma_h: float | Expression = 0.0,
    corner_Hz: float | Expression = 0.0,
    frame_rate_Hz: float | Expression = 30.0,
    longest_period_s: float | Expression = 60.0,
) -> Part:
    """Add 3-D noise from its components: time (t), rows (v), columns (h) and their combinations.

    Each component is Gaussian with its own standard deviation, in the unit of the picture. In a
    sequence, v, h and vh are the same in every frame, and the other components are new in each
    frame. `corner_Hz` adds 1/f noise to each sample; at this frequency, 1/f noise and sigma_tvh
    have the same spectral density. The 1/f noise extends from 1/`longest_period_s` to half the
    frame rate, and any frame can be computed independently. All variance of the 1/f noise is
    temporal. 3-D Noise analyses a limited number of frames, so it counts changes over longer times
    as fixed pattern (vh). Without any component, the picture does not change. Sources: D'Agostino
    and Webb 1991; for 1/f, Shinozuka and Deodatis 1991 (spectral representation).

    Parameters
    ----------
    seed_mode : Literal['automatic', 'typed']
        derive the seed from the network's seed and this node's name, or enter it in seed: one of
        automatic, typed; default 'automatic'
    seed : int | Expression
        seed, used when seed_mode is typed: a whole number from 0 to 9.22337e+18; default 0
    sigma_tvh : float | Expression
        rms random noise, from pixel to pixel and frame to frame: a number from 0 to 1e+15; default
        0.0
    sigma_tv : float | Expression
        rms row noise that changes from frame to frame: a number from 0 to 1e+15; default 0.0
    sigma_th : float | Expression
        rms column noise that changes from frame to frame: a number from 0 to 1e+15; default 0.0
    sigma_t : float | Expression
        rms flicker of the whole frame: a number from 0 to 1e+15; default 0.0
    sigma_vh : float | Expression
        rms fixed pattern, pixel by pixel: a number from 0 to 1e+15; default 0.0
    sigma_v : float | Expression
        rms row noise, the same in every frame: a number from 0 to 1e+15; default 0.0
    sigma_h : float | Expression
        rms column noise, the same in every frame: a number from 0 to 1e+15; default 0.0
    corner_Hz : float | Expression
        corner frequency, where 1/f noise and sigma_tvh have equal spectral density; 0: no 1/f noise
        [Hz]: a number from 0 to 1e+09; default 0.0
    frame_rate_Hz : float | Expression
        frame rate, for 1/f noise [Hz]: a number from 1e-06 to 1e+09; default 30.0
    longest_period_s : float | Expression
        longest period of the 1/f noise: time since the last correction [s]: a number from 1e-09 to
        1e+09; default 60.0

    Notes
    -----
    3-D Noise Source, in the group Electronics & Noise.
    Inputs: image.
    Outputs: image, noise.
    Read-outs: temporal, fixed, flicker.
    """

def mtf_slices(
    *,
    direction: Literal['horizontal', 'vertical', 'angle', 'both'] = 'horizontal',
    angle_deg: float | Expression = 45.0,
    samples: int | Expression = 257,
    stages: bool = True,
) -> Part:
    """Plot the MTF of each stage and of the total along a line, from zero to Nyquist.

    Stages are evaluated only on the plotted line, so the plot is fast. For a magnitude, the MTFs
    are plotted, not the picture's spectrum; for a PTF, the phases and their sum. The plot ends at
    the Nyquist frequency of the image's samples. The pixels' Nyquist frequency, half a cycle per
    pitch, is marked if Init & Trans or Camera has a pitch. Source: Tantalo 1996, figs. 5.26 and
    5.53.

    Parameters
    ----------
    direction : Literal['horizontal', 'vertical', 'angle', 'both']
        direction of the slice; both: horizontal and vertical: one of horizontal, vertical, angle,
        both; default 'horizontal'
    angle_deg : float | Expression
        angle of the slice: 0 horizontal, 90 vertical [deg]: a number from -360 to 360; default 45.0
    samples : int | Expression
        number of points on each curve: a whole number from 2 to 65536; default 257
    stages : bool
        show every stage, not only the total: true or false; default True

    Notes
    -----
    MTF Slices, in the group Analysis.
    Inputs: transfer.
    Outputs: curve.
    Read-outs: at_nyquist_x, at_nyquist_y, at_pixel_nyquist_x, at_pixel_nyquist_y.
    """

def measured_mtf(
    *,
    method: Literal['slanted_edge', 'row_average'] = 'slanted_edge',
    target: Literal['edge', 'line'] = 'edge',
    direction: Literal['automatic', 'horizontal', 'vertical'] = 'automatic',
    region_x: int | Expression = 0,
    region_y: int | Expression = 0,
    region_width: int | Expression | None = None,
    region_height: int | Expression | None = None,
    window: Literal['tukey', 'hamming', 'none'] = 'tukey',
    samples: int | Expression = 129,
    clip_left_px: int | Expression | None = None,
    clip_right_px: int | Expression | None = None,
    axis: Literal['cyc_per_mrad', 'cyc_per_pixel'] = 'cyc_per_mrad',
) -> Part:
    """Measure the MTF from an edge or a line in a picture.

    `slanted_edge` finds the angle of the edge and sorts the samples into quarter-sample bins by
    their distance from the edge. The derivative of the bin means is windowed, Fourier transformed,
    and corrected for the responses of the bins and of the derivative. Frequencies are measured
    along the edge's normal. `row_average` averages the rows, drops the flat ends and Fourier
    transforms the derivative. The MTF of `row_average` is the modulus of the Fourier transform,
    divided by its largest value; the response of the derivative, 0.64 at Nyquist, is not corrected
    for. Standard errors are estimated by leaving out rows (jackknife).

    `expected` is the MTF of the picture's chain in the same direction, up to Nyquist. The expected
    MTF includes all stages from the source on and, for a test scene, the blur of the scene's
    samples, which are means over their area. The blur of a scene from a file is unknown and not
    included; a picture straight from a file has no expected MTF. Aliasing in `row_average` is not
    included. `imagechain measure` finds the edges in pictures of real cameras. Source: ISO
    12233:2023; Tantalo 1996, eqs. 5.67 to 5.70 and appendix B.

    Parameters
    ----------
    method : Literal['slanted_edge', 'row_average']
        method: ISO 12233 for a slanted edge, or the row average of Tantalo 1996 for a vertical
        edge: one of slanted_edge, row_average; default 'slanted_edge'
    target : Literal['edge', 'line']
        feature in the region: an edge, or a line (its width counts as blur): one of edge, line;
        default 'edge'
    direction : Literal['automatic', 'horizontal', 'vertical']
        direction of the measurement: horizontal (for a vertical edge), vertical, or automatic: the
        direction of the larger change: one of automatic, horizontal, vertical; default 'automatic'
    region_x : int | Expression
        first column of the region [px]: a whole number of at least 0; default 0
    region_y : int | Expression
        first row of the region [px]: a whole number of at least 0; default 0
    region_width : int | Expression | None
        columns in the region; empty: to the picture's end [px]: a whole number of at least 0 or
        empty; default empty
    region_height : int | Expression | None
        rows in the region; empty: to the picture's end [px]: a whole number of at least 0 or empty;
        default empty
    window : Literal['tukey', 'hamming', 'none']
        window on the line spread function; tukey: flat over its middle half: one of tukey, hamming,
        none; default 'tukey'
    samples : int | Expression
        number of points on the curve: a whole number from 2 to 4096; default 129
    clip_left_px : int | Expression | None
        first sample of the edge along the measurement, counted from 0 at the region's start; empty:
        found automatically [px]: a whole number of at least 0 or empty; default empty
    clip_right_px : int | Expression | None
        last sample of the edge along the measurement, counted from 0 at the region's start; empty:
        found automatically [px]: a whole number of at least 0 or empty; default empty
    axis : Literal['cyc_per_mrad', 'cyc_per_pixel']
        unit of the frequency axis; always cycles per pixel if the picture has no sampling interval:
        one of cyc_per_mrad, cyc_per_pixel; default 'cyc_per_mrad'

    Notes
    -----
    Measured MTF, in the group Analysis.
    Inputs: image.
    Outputs: curve, spread, table.
    Read-outs: mtf50 (cyc/mrad), mtf50_error (cyc/mrad), mtf50_per_pixel (cyc/pixel), mtf10
    (cyc/mrad), mtf10_per_pixel (cyc/pixel), at_nyquist, at_nyquist_error, expected_mtf50
    (cyc/mrad), expected_at_nyquist, largest_difference, edge_angle_deg (deg).
    """

def figures_of_merit(
    *,
    model: Literal['ratches_1976', 'flir92'] = 'flir92',
    scanning: Literal['automatic', 'parallel_scan', 'serial_scan', 'staring'] = 'automatic',
    cut_on_um: float | Expression | None = None,
    cut_off_um: float | Expression | None = None,
    background_K: float | Expression | None = None,
    snr_threshold: float | Expression = 2.5,
    frame_rate_Hz: float | Expression | None = 30.0,
    eye_integration_s: float | Expression = 0.2,
    mdtd_window: Literal['target', 'image'] = 'target',
    eye_limit_mrad: float | Expression | None = None,
    target_size_m: float | Expression = 2.3,
    target_delta_K: float | Expression = 2.0,
    extinction_per_km: float | Expression = 0.2,
    n50_detection: float | Expression = 0.75,
    n50_recognition: float | Expression = 3.0,
    n50_identification: float | Expression = 6.0,
    ttp_threshold: Literal['mrtd', 'system_contrast_threshold'] = 'mrtd',
    v50: float | Expression = 18.8,
    scene_contrast_K: float | Expression = 5.0,
    display_cd_m2: float | Expression = 34.0,
    display_deg: float | Expression = 15.0,
    magnification: float | Expression | None = None,
    range_max_km: float | Expression | None = None,
) -> Part:
    """Compute SNR, NETD, MRTD, MDTD and acquisition ranges of the sensor that took a picture.

    The transfer function and the noise are predicted from the picture's chain; no noise is
    simulated or measured. The SNR and the background temperature use the picture's mean without
    noise, gain errors or bias errors. Connect the picture as the sensor samples it, before a frame
    grabber interpolates it: its samples set the Nyquist frequency and the noise bandwidth.

    MRTD (four bars, 7:1): (π²/8)·SNR_th·σ/H, with the noise σ that remains after the eye has
    averaged over a bar and over time. `ratches_1976` uses temporal noise only and has no sampling
    limit. `flir92` also uses fixed-pattern noise, which does not average out over time. In the
    directions in which the sensor samples, the `flir92` MRTD ends at the Nyquist frequency. The
    average over a bar takes the spectrum of the temporal noise into account. The frequency of the
    2-D MRTD is the geometric mean of the horizontal and vertical frequencies with the same MRTD.
    MDTD (square target): SNR_th·σ divided by the mean of the target's blurred image.

    `scanning` sets the directions in which the sensor samples. `staring` samples in both
    directions. `serial_scan` samples only from line to line, because one detector scans along x.
    `parallel_scan` samples only from detector to detector: along x on platform `push`, otherwise
    along y. The noise also depends on the scanning and is taken from the picture. One detector in
    place of n must scan n times as fast, which raises bandwidth_Hz by a factor of n and the noise
    by √n. With one detector (platform `line`), gain and bias errors leave no pattern. On `push`,
    gain and bias errors cause σ_h, which masks vertical bars; on `array`, they cause σ_vh. The 1/f
    noise of detector channels (σ_tv) is not simulated.

    A picture in a band that begins below 2.5 µm is formed by reflected light, which has no
    temperature. Use Image Quality for a picture formed by reflected light. If the scene is hot
    enough to emit in the band, enter its temperature in `background_K`. All figures in K are
    apparent values at the camera, after the atmosphere, for the background's apparent temperature.
    The apparent ΔT at a range is ΔT·exp(−extinction·range). After an Atmospheric Path, the apparent
    ΔT follows from the path's τ(R) at each wavelength, weighted by dL/dT.

    Johnson: the probability depends on the number of cycles resolved across the target, divided by
    N50. The highest frequency resolved is the one at which the target's apparent ΔT equals the 2-D
    MRTD.

    TTP: the probability depends on the sum of √(contrast/threshold) over frequencies. With `mrtd`
    the threshold is the root sum of squares of CTF_eye/MTF and the contrast of the MRTD. With
    `system_contrast_threshold` the threshold is the published CTF_eye/MTF·√(1 + α²·σ²/S²); use
    published V50 values with this threshold. Here α = 169.6 √Hz, S is the scene contrast, and σ is
    the noise in K·√s that passes the eyeball and the eye's visual channel at each frequency. With
    `flir92`, σ includes fixed-pattern noise. The MRTD includes neither the display nor the eye's
    contrast threshold. The defaults are a target of 2.3 m with ΔT = 2 K, and N50 for the 2-D MRTD.
    A V50 of 18.8 is quoted for identifying tracked vehicles; this value could not be checked.

    Sources: Ratches et al. 1975, ECOM-7043; Ratches 1976, Opt. Eng. 15, 525; Scott and D'Agostino
    1992, Proc. SPIE 1689, 194 (FLIR92); Johnson 1958; Ratches, Vollmerhausen and Driggers 2001,
    IEEE Sensors J. 1, 31 (N50); Vollmerhausen, Jacobs and Driggers 2004, Opt. Eng. 43, 2806; Barten
    1990 (eye). Equation numbers are omitted, because they could not be checked.

    Parameters
    ----------
    model : Literal['ratches_1976', 'flir92']
        MRTD model: temporal noise only (ratches_1976), or 3-D noise with a sampling limit (flir92):
        one of ratches_1976, flir92; default 'flir92'
    scanning : Literal['automatic', 'parallel_scan', 'serial_scan', 'staring']
        how the picture is scanned; automatic: from Init & Trans's platform (line: serial, push:
        parallel, array: staring): one of automatic, parallel_scan, serial_scan, staring; default
        'automatic'
    cut_on_um : float | Expression | None
        shortest wavelength; empty: from the image's band [µm]: a number of at least 0 or empty;
        default empty
    cut_off_um : float | Expression | None
        longest wavelength; empty: from the image's band [µm]: a number of at least 0 or empty;
        default empty
    background_K : float | Expression | None
        background temperature; empty: brightness temperature of the picture's mean [K]: a number of
        at least 0 or empty; default empty
    snr_threshold : float | Expression
        SNR at which half of the observers resolve the bars or detect the target: a number above 0
        to 1000; default 2.5
    frame_rate_Hz : float | Expression | None
        frames per second; empty: a single still frame [Hz]: a number of at least 0 or empty;
        default 30.0
    eye_integration_s : float | Expression
        time over which the eye averages frames [s]: a number above 0 to 10; default 0.2
    mdtd_window : Literal['target', 'image']
        MDTD: whether the eye averages over the target or over its blurred image: one of target,
        image; default 'target'
    eye_limit_mrad : float | Expression | None
        MDTD: largest angle in the scene over which the eye averages; empty: no limit [mrad]: a
        number of at least 0 or empty; default empty
    target_size_m : float | Expression
        characteristic dimension of the target: the square root of its area [m]: a number above 0 to
        1e+06; default 2.3
    target_delta_K : float | Expression
        temperature difference between target and background [K]: a number from -10000 to 10000;
        default 2.0
    extinction_per_km : float | Expression
        extinction coefficient of the air in the band, used if there is no Atmospheric Path [1/km]:
        a number from 0 to 1e+06; default 0.2
    n50_detection : float | Expression
        cycles across the target for 50 % detection with the 2-D MRTD (1 with the 1-D MRTD): a
        number above 0 to 1000; default 0.75
    n50_recognition : float | Expression
        cycles across the target for 50 % recognition with the 2-D MRTD (4 with the 1-D MRTD): a
        number above 0 to 1000; default 3.0
    n50_identification : float | Expression
        cycles across the target for 50 % identification with the 2-D MRTD (6.4 with the 1-D MRTD):
        a number above 0 to 1000; default 6.0
    ttp_threshold : Literal['mrtd', 'system_contrast_threshold']
        TTP: contrast threshold from the eye and the MRTD, or the published threshold from MTF and
        noise: one of mrtd, system_contrast_threshold; default 'mrtd'
    v50 : float | Expression
        TTP value for 50 % success; use published values with system_contrast_threshold: a number
        above 0 to 10000; default 18.8
    scene_contrast_K : float | Expression
        TTP: temperature difference that corresponds to the mean luminance of the display [K]: a
        number above 0 to 10000; default 5.0
    display_cd_m2 : float | Expression
        TTP: mean luminance of the display [cd/m²]: a number above 0 to 1e+06; default 34.0
    display_deg : float | Expression
        TTP: angle that the display subtends at the eye [deg]: a number above 0 to 180; default 15.0
    magnification : float | Expression | None
        TTP: magnification, angle on the display / angle in the scene; empty: the picture fills the
        display: a number of at least 0 or empty; default empty
    range_max_km : float | Expression | None
        longest range on the curve; empty: automatic, the range at which the probability of
        detection is 10 % (Johnson) or of success 50 % (TTP), whichever is longer [km]: a number
        from 0 to 1e+06 or empty; default empty

    Notes
    -----
    Figures of Merit, in the group Analysis.
    Inputs: context, image.
    Outputs: mrtd, mdtd, probability, table.
    Read-outs: snr, netd_K (K), ner (W/m²/sr), mrtd_x_K (K), mrtd_y_K (K), detection_range_km (km),
    recognition_range_km (km), identification_range_km (km), ttp_range_km (km).
    """

def noise_budget(
    *,
    frequency: float | Expression = 0.5,
    noise: Literal['all', 'temporal', 'fixed'] = 'all',
    show: Literal['share', 'amount'] = 'share',
) -> Part:
    """Show how much each source contributes to the noise, and each stage to the blur.

    Everything is computed from the picture's chain; no noise is simulated. The noise of each source
    is propagated to the picture through all later filters, pixel combining and interpolation.
    Variances of independent noises add, so each source has a share of the sum. `fixed` means
    fixed-pattern noise, the same in every frame, averaged over all sensors of the same design.
    Quantization noise is included. Moduli of MTFs multiply, so −ln |MTF| adds; at one frequency the
    share of a Gaussian blur is proportional to its variance. A stage that amplifies has a negative
    share: it recovers part of the loss. A stage with an MTF of zero is assigned all of the blur.
    Phases do not count as blur.

    Parameters
    ----------
    frequency : float | Expression
        frequency at which the blur is budgeted, as a fraction of the picture's Nyquist frequency
        [Nyquist]: a number above 0 to 1; default 0.5
    noise : Literal['all', 'temporal', 'fixed']
        noise in the budget: all noise, temporal noise (changes from frame to frame), or fixed-
        pattern noise: one of all, temporal, fixed; default 'all'
    show : Literal['share', 'amount']
        length of the bars: share in per cent, or amount (standard deviation of the noise, −ln of
        the MTF for the blur): one of share, amount; default 'share'

    Notes
    -----
    Noise Budget, in the group Analysis.
    Inputs: image.
    Outputs: noise, blur, table.
    Read-outs: sigma, sigma_temporal, sigma_fixed, mtf_x, mtf_y, xi (cyc/mrad), eta (cyc/mrad).
    """

def noise_3d(
    *,
    frames: int | Expression = 16,
    path: str | PathLike[str] | None = None,
) -> Part:
    """Split noise into its 3-D components: time (t), rows (v), columns (h), and their combinations.

    Predicted: the noise of every source in the chain is propagated to this picture through all
    later transfer functions, pixel combining and interpolation. Measured: frames of the picture are
    simulated, each with its own temporal noise and the same fixed patterns. The noise-free picture
    is subtracted, and unbiased estimates split the variance into the seven components. The
    prediction is an average over all sensors of the same design; the measurement contains one
    sensor's pattern. With few rows or columns, the measured fixed components therefore scatter
    about the prediction. Noise correlated between neighbouring samples also appears in σ tv and σ
    th. Quantization noise is included. With `path`, the frames of a file, for example from a
    camera, are measured instead of simulated frames; they are read one at a time. In a file,
    everything that stays the same from frame to frame, including the scene, counts as fixed
    pattern. Use frames of a uniform scene. If a picture is also connected, its predicted noise is
    shown beside the measurement. Sources: D'Agostino and Webb 1991; Scott and D'Agostino 1992
    (FLIR92); Searle, Casella and McCulloch 1992, Variance Components (unbiased estimates).

    Parameters
    ----------
    frames : int | Expression
        number of frames to simulate; 0: prediction only; with path, all frames of the file are
        measured: a whole number from 0 to 100000; default 16
    path : str | PathLike[str] | None
        file of frames to measure instead of simulated frames: .npy (frames, rows, columns), TIFF
        with a page per frame, or ENVI with a band per frame; empty: simulate: a file name or empty;
        default empty

    Notes
    -----
    3-D Noise, in the group Analysis.
    Inputs: image (optional).
    Outputs: curve, table.
    Read-outs: sigma_tvh, sigma_vh, sigma_v, sigma_h, sigma_t, sigma_tv, sigma_th, temporal, fixed,
    temporal_measured, fixed_measured.
    """

def compare_images(
    *,
    average: Literal['axes', 'radial'] = 'axes',
    edges: Literal['reflect', 'periodic'] = 'reflect',
) -> Part:
    """Measure the difference between a picture and a reference of the same size.

    The read-outs are the root mean square, largest and mean differences, and the peak
    signal-to-noise ratio (PSNR). The PSNR's peak is the reference's maximum minus its minimum. The
    MTF ratio is the modulus of the picture's spectrum divided by the modulus of the reference's
    spectrum, along both frequency axes. Averaged in rings, the ratio is the square root of the
    ratio of the power spectra. Frequencies at which the reference contains only rounding errors are
    left out. For a frame filtered with mirrored edges, set `edges` to `reflect`; the ratio is then
    the MTF itself.

    Parameters
    ----------
    average : Literal['axes', 'radial']
        MTF ratio along both frequency axes, or averaged in rings: one of axes, radial; default
        'axes'
    edges : Literal['reflect', 'periodic']
        how the frame continues beyond its edges: mirrored, or repeated as in a plain FFT: one of
        reflect, periodic; default 'reflect'

    Notes
    -----
    Compare Images, in the group Analysis.
    Inputs: image, reference.
    Outputs: table, difference, curve.
    Read-outs: rmse, max_error, psnr_dB (dB), mean_difference.
    """

def spatial_blur(
    *,
    truncation: Literal['half_width', 'error', 'none'] = 'half_width',
    half_width_px: int | Expression = 16,
    error: float | Expression = 0.001,
) -> Part:
    """Blur a picture by convolution with the impulse response, in place of Back Transform.

    The inputs are the same as for Back Transform. The impulse response is the inverse transform of
    all collected MTFs and PTFs. A separable response is applied in one pass along x and one along
    y; any other response is applied as a two-dimensional kernel. Complete kernels give the same
    result as Back Transform, except for rounding. A truncated kernel has an error of at most
    `error_bound` times the scene's largest deviation from its mean. The bound is the sum of the
    moduli of the kernel values that are cut off. The picture's mean does not change. If a transfer
    function has not fallen to zero at Nyquist, its kernel rings and cannot be both short and
    precise.

    Two passes are faster than Fourier filtering only with short kernels on small frames: up to ±16
    samples on 128 × 128, and up to ±4 on 512 × 512. Two-dimensional kernels are always slower
    (`imagechain bench`, table spatial). Source: NVSIM's method (Horger 1993) as in Tantalo 1996,
    section 2.1.4.

    Parameters
    ----------
    truncation : Literal['half_width', 'error', 'none']
        where kernels are truncated: at half_width_px, where the error reaches `error`, or at the
        frame's size: one of half_width, error, none; default 'half_width'
    half_width_px : int | Expression
        kernel samples kept on each side of the centre [px]: a whole number from 0 to 65536; default
        16
    error : float | Expression
        largest error allowed, as a fraction of the scene's largest deviation from its mean: a
        number from 0 to 1; default 0.001

    Notes
    -----
    Spatial Blur, in the group Analysis.
    Inputs: magnitude, phase.
    Outputs: image, curve, table.
    Read-outs: taps, error_bound.
    """

def line_by_line(
    *,
    scan: Literal['x', 'y'] = 'x',
    look_angle_deg: float | Expression = 0.0,
    nadir_column: float | Expression | None = None,
    spacing: Literal['frame', 'flight', 'typed'] = 'frame',
    line_spacing_m: float | Expression | None = None,
    altitude_m: float | Expression | None = None,
    method: Literal['nodes', 'direct'] = 'nodes',
    nodes: int | Expression | None = None,
    tolerance: float | Expression = 1e-05,
) -> Part:
    """Filter a line scanner's frame at its true sampling intervals, in place of Back Transform.

    A line scanner samples at equal angles along the scan and at equal distances on the ground along
    the flight. Away from nadir the ground is farther away, and the lines are closer in angle:
    interval·cos(view angle). Back Transform uses one interval for the whole frame, as the 1996
    model does (output `whole`). Line by Line filters each column at its own interval (output
    `image`). Factors along the scan use one interval for the whole frame; factors along the flight
    use one interval per column. Pupils and other non-separable factors use the intervals along the
    scan and along the flight. All factors use angles at the sensor, as in the modules that supply
    them; frame edges and PTFs are treated as in Back Transform. Separable factors are exact.
    Non-separable factors are interpolated between a few sampling intervals (`nodes`), with an
    estimate of the error, or summed exactly for each interval (`direct`). Pushbroom scanners and
    arrays sample evenly, so the outputs `image` and `whole` agree. The ground is assumed to be
    flat, and motion blur is assumed to cover the same angle as at nadir.

    When is one interval for the whole image good enough? The error of a single interval grows as 1
    − cos(view angle). The network `line_by_line` blurs the built-in scene by three samples, as the
    Inframetrics scanner does. There the largest error is 0.03 % of the picture's peak-to-peak range
    for a field of view of 10°, 0.5 % for 30°, 1.1 % for 45°, 2 % for 60°, 5 % for 90° and 10 % for
    120°. The rms errors for fields of view of 10°, 30°, 45°, 60°, 90° and 120° are 0.002, 0.02,
    0.05, 0.1, 0.25 and 0.5 %. In the 30° field of view of Tantalo 1996, six-bit quantization hides
    the error. Filtering line by line takes 1.3 to 4 times as long as filtering the whole image
    (`imagechain bench`, table scanning); `direct` takes 60 times as long or more. Source: Tantalo
    1996, section 2 and fig. 2.3; the thesis leaves the comparison to later work.

    Parameters
    ----------
    scan : Literal['x', 'y']
        axis of the frame along which a line is scanned: one of x, y; default 'x'
    look_angle_deg : float | Expression
        look angle from nadir at the middle of the frame [deg]: a number above -90 below 90; default
        0.0
    nadir_column : float | Expression | None
        index of the scan line's sample at nadir, counted from 0; empty: from the look angle [px]: a
        number from -65536 to 131072 or empty; default empty
    spacing : Literal['frame', 'flight', 'typed']
        line spacing at nadir; frame: the frame's interval; flight: from velocity and scan velocity
        on Init & Trans, one line per 360° of scan; typed: line_spacing_m: one of frame, flight,
        typed; default 'frame'
    line_spacing_m : float | Expression | None
        distance between scan lines on the ground [m]: a number of at least 0 or empty; default
        empty
    altitude_m : float | Expression | None
        altitude above the ground; empty: from Init & Trans [m]: a number of at least 0 or empty;
        default empty
    method : Literal['nodes', 'direct']
        how non-separable factors are computed: interpolated between a few sampling intervals
        (nodes), or summed exactly for each interval (direct): one of nodes, direct; default 'nodes'
    nodes : int | Expression | None
        number of sampling intervals to interpolate between; empty: as many as the tolerance
        requires: a whole number from 0 to 32 or empty; default empty
    tolerance : float | Expression
        largest interpolation error allowed in the transfer function: a number from 0 to 1; default
        1e-05

    Notes
    -----
    Line by Line, in the group Analysis.
    Inputs: context, magnitude, phase.
    Outputs: image, whole, difference, curve, table.
    Read-outs: rms_percent (%), max_percent (%), max_view_deg (deg), interval_nadir_mrad (mrad),
    interval_edge_mrad (mrad), scale_nodes, error_percent (%).
    """

def camera_geometry(
    *,
    kind: Literal['line', 'pushbroom', 'framing'] = 'line',
    altitude_m: float | Expression = 1000.0,
    ground_interval_m: float | Expression | None = None,
    ground_interval_y_m: float | Expression | None = None,
    columns: int | Expression | None = None,
    rows: int | Expression | None = None,
    fov_x_deg: float | Expression | None = 20.0,
    pitch_x_um: float | Expression | None = None,
    pitch_y_um: float | Expression | None = None,
    focal_length_mm: float | Expression | None = None,
    velocity_m_per_s: float | Expression | None = None,
    line_rate_Hz: float | Expression | None = None,
    roll_deg: float | Expression = 0.0,
    pitch_deg: float | Expression = 0.0,
    yaw_deg: float | Expression = 0.0,
    offset_x_m: float | Expression = 0.0,
    offset_y_m: float | Expression = 0.0,
    interpolation: Literal['area', 'bilinear', 'cubic'] = 'area',
    strips: int | Expression = 4,
    outside: Literal['refuse', 'fill'] = 'refuse',
    fill_value: float | Expression = 0.0,
) -> Part:
    """Sample a scene on flat ground as a line scanner, pushbroom or framing camera does.

    The scene is sampled in equal steps on the ground, and its centre is at nadir. A line scanner
    samples at equal angles, so its ground samples grow with the view angle θ, as sec²θ across the
    track and as sec θ along it (panoramic distortion). A pushbroom scanner and a framing camera
    sample at equal steps in the focal plane. The flight direction is down the picture, and scan
    lines are equally spaced on the ground. Each sample is the mean of the scene over its whole
    footprint, which limits aliasing and keeps a uniform scene uniform. Blur is applied afterwards:
    choose samples smaller than the pixels, apply Detector MTF, and then use Sample Pixels.

    Footprints aligned with the scene's rows and columns (no yaw) are exact. With roll or pitch
    alone, a framing camera's footprints are exact to 10⁻⁴ of the scene's peak-to-peak signal. Other
    footprints are oblique: each is cut into `strips` strips, and the error is estimated. Source:
    Tantalo 1996, sections 2 and 5.3, for the Salacain camera.

    Parameters
    ----------
    kind : Literal['line', 'pushbroom', 'framing']
        line scanner, pushbroom, or framing camera (exposes all lines at once): one of line,
        pushbroom, framing; default 'line'
    altitude_m : float | Expression
        height above the ground [m]: a number above 0; default 1000.0
    ground_interval_m : float | Expression | None
        sampling interval of the scene on the ground; empty: angular interval × altitude [m]: a
        number of at least 0 or empty; default empty
    ground_interval_y_m : float | Expression | None
        sampling interval of the scene down the picture; empty: equal to ground_interval_m [m]: a
        number of at least 0 or empty; default empty
    columns : int | Expression | None
        samples per line; empty: the number in the scene: a whole number from 1 to 65536 or empty;
        default empty
    rows : int | Expression | None
        number of lines; empty: the number in the scene: a whole number from 1 to 65536 or empty;
        default empty
    fov_x_deg : float | Expression | None
        field of view across the track; empty: from pixel pitch and focal length [deg]: a number
        from 0 below 180 or empty; default 20.0
    pitch_x_um : float | Expression | None
        pixel pitch across the track [µm]: a number of at least 0 or empty; default empty
    pitch_y_um : float | Expression | None
        pixel pitch along the track; empty: equal to pitch_x_um [µm]: a number of at least 0 or
        empty; default empty
    focal_length_mm : float | Expression | None
        focal length [mm]: a number of at least 0 or empty; default empty
    velocity_m_per_s : float | Expression | None
        ground speed, given together with line_rate_Hz; both empty: lines touch at nadir [m/s]: a
        number of at least 0 or empty; default empty
    line_rate_Hz : float | Expression | None
        lines per second, given together with velocity_m_per_s; both empty: lines touch at nadir
        [Hz]: a number of at least 0 or empty; default empty
    roll_deg : float | Expression
        look angle to the right [deg]: a number from -89 to 89; default 0.0
    pitch_deg : float | Expression
        look angle ahead [deg]: a number from -89 to 89; default 0.0
    yaw_deg : float | Expression
        heading, clockwise from straight down the picture [deg]: a number from -180 to 180; default
        0.0
    offset_x_m : float | Expression
        distance of the camera from the scene's centre, to the right in the picture [m]: a number;
        default 0.0
    offset_y_m : float | Expression
        distance of the camera from the scene's centre, down the picture [m]: a number; default 0.0
    interpolation : Literal['area', 'bilinear', 'cubic']
        interpolation between scene samples: constant over each sample (area), linear (bilinear), or
        smooth (cubic: each sample keeps its mean): one of area, bilinear, cubic; default 'area'
    strips : int | Expression
        number of strips per oblique footprint: a whole number from 1 to 64; default 4
    outside : Literal['refuse', 'fill']
        if a footprint lies beyond the scene: report an error (refuse), or use fill_value (fill):
        one of refuse, fill; default 'refuse'
    fill_value : float | Expression
        value beyond the scene, in the scene's unit: a number; default 0.0

    Notes
    -----
    Camera Geometry, in the group Analysis.
    Inputs: image.
    Outputs: image, coverage, curve, table.
    Read-outs: swath_m (m), gsd_x_m (m), gsd_y_m (m), gsd_edge_x_m (m), gsd_edge_y_m (m),
    panoramic_factor, interval_x_mrad (mrad), interval_y_mrad (mrad), line_spacing_m (m), lines,
    footprint_error.
    """

def image_quality(
    *,
    range_m: float | Expression | None = None,
    gsd_m: float | Expression | None = None,
    elevation_deg: float | Expression | None = None,
    off_nadir_deg: float | Expression = 0.0,
    snr: float | Expression | None = None,
    snr_of: Literal['contrast', 'mean'] = 'contrast',
    rer_x: float | Expression | None = None,
    rer_y: float | Expression | None = None,
    overshoot: float | Expression | None = None,
    noise_gain: float | Expression = 1.0,
) -> Part:
    """Estimate the interpretability (NIIRS) of a picture with GIQE 3, 4 and 5.

    In the plane normal to the line of sight, the ground sample distance (GSD) is the picture's
    sampling interval times the range. GIQE 3 uses the GSD normal to the line of sight. GIQE 4 uses
    the GSD on the ground: GSD/√sin e, where e is the elevation of the line of sight seen from the
    target. GIQE 5 uses the geometric mean of the GSDs of GIQE 3 and 4, GSD/(sin e)^¼. The relative
    edge response (RER) is the rise of the edge response from half a sample before the edge to half
    a sample after it. The overshoot H is the maximum of the edge response 1 to 3 samples beyond the
    edge; if the response only rises there, H is the response at 1.25 samples. RER and H follow from
    the chain's transfer functions; the SNR follows from the chain's signal and temporal noise. No
    noise is simulated or measured. GSD, RER and H are geometric means of the horizontal and
    vertical values; in GIQE 5 the worse RER counts twice. Connect the picture as the sensor samples
    it, before a frame grabber interpolates it.

    With `snr_of` = `contrast`, the SNR is the difference in signal between surfaces of 15 % and 7 %
    reflectance, divided by the noise. If the scene is in reflectance and Reflected Light converts
    it to radiance, the difference follows from the illumination and the atmosphere set in that
    module. If the scene is not in reflectance, the mean radiance is assumed to come from a surface
    of 15 % reflectance, and a warning is shown. The SNR is then 8/15 of the mean signal divided by
    the noise. With `mean`, the SNR is the mean signal divided by the noise.

    GIQE 3: 11.81 + 3.32·lg(RER/GSD) − 1.48·H − G/SNR. GIQE 4: 10.251 − a·lg GSD + b·lg RER −
    0.656·H − 0.344·G/SNR (a = 3.32, b = 1.559; below an RER of 0.9, a = 3.16, b = 2.817). GIQE 5:
    9.57 − 3.32·lg GSD + 3.32·(1 − e^(−1.9/SNR))·lg RER − 2·lg⁴ RER − 1.8/SNR. GSD in inches. GIQE 3
    and 4 apply to sharpened pictures, with the noise gain G of the sharpening. GIQE 4 was fitted to
    visible pictures with GSD 3 to 80 inches, RER 0.2 to 1.3, H 0.9 to 1.9 and SNR 2 to 130. A
    warning lists values outside the limits of GIQE 4. The limits of GIQE 3 and 5 could not be
    verified.

    Sources: Leachtenauer et al. 1997, Appl. Opt. 36, 8322 (GIQE 3 and 4, SNR); Harrington et al.
    2015, GIQE version 5.0, NGA, 16 September 2015 (eqs. 2, 5 and 7).

    Parameters
    ----------
    range_m : float | Expression | None
        slant range to the ground; empty: from Init & Trans [m]: a number of at least 0 or empty;
        default empty
    gsd_m : float | Expression | None
        ground sample distance normal to the line of sight, if you know it; empty: interval × range,
        the sampling interval times the slant range [m]: a number of at least 0 or empty; default
        empty
    elevation_deg : float | Expression | None
        elevation of the line of sight at the target; empty: 90° − off nadir, or from Camera's orbit
        if off_nadir_deg is 0 [deg]: a number from 0 to 90 or empty; default empty
    off_nadir_deg : float | Expression
        off-nadir look angle along the track, over flat ground; used if elevation_deg is empty
        [deg]: a number from 0 to 89; default 0.0
    snr : float | Expression | None
        SNR, if you know it; empty: signal / temporal noise: a number of at least 0 or empty;
        default empty
    snr_of : Literal['contrast', 'mean']
        signal for the SNR: the contrast between 15 % and 7 % reflectance, or the mean: one of
        contrast, mean; default 'contrast'
    rer_x : float | Expression | None
        horizontal RER, if you know it; empty: from the chain: a number of at least 0 or empty;
        default empty
    rer_y : float | Expression | None
        vertical RER, if you know it; empty: from the chain: a number of at least 0 or empty;
        default empty
    overshoot : float | Expression | None
        overshoot H, if you know it; empty: from the chain: a number of at least 0 or empty; default
        empty
    noise_gain : float | Expression
        noise gain G of the sharpening; 1: no sharpening: a number from 0 to 1e+06; default 1.0

    Notes
    -----
    Image Quality, in the group Analysis.
    Inputs: context, image.
    Outputs: edge, table.
    Read-outs: giqe5 (NIIRS), giqe4 (NIIRS), giqe3 (NIIRS), gsd_m (m), gsd_ground_m (m), rer,
    overshoot, snr.
    """
