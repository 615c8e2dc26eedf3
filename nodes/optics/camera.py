"""Camera: the data sheet of a camera, entered once for the whole network."""

import math
from typing import Any, NamedTuple

from core.chain.wires import CameraSheet, Image, Table, TableData
from core.evaluation.work import Work
from core.modules.declaration import Caution, Formula, Module, NodeContext, Section, param, warning
from core.physics.detector.focal_plane_array import Irradiance, solid_angle
from core.physics.sampling import ground_geometry
from core.physics.sampling.detector_sampling import field_of_view_deg
from core.records import replace
from nodes.shared.context_defaults import F_NUMBER_NEAR, NEAR, alike, apart, apart_caution, first
from nodes.shared.module_ports import TableFigures


class CameraOutputs(NamedTuple):
    image: Image
    camera: Table


Angle = float | None
_LOW_ORBIT_KM = 2000.0  # up to here the Earth's rotation changes the speed by less than 9 %
_EARTH_M_PER_S = (
    2.0 * math.pi * ground_geometry.EARTH_RADIUS_KM * 1e3 / 86164.1
)  # at the equator; sidereal day
_GIVEN = ("pixels_x", "pixels_y", "fill_x", "fill_y", "obscuration_ratio", "t_number", "irradiance")
_ORBIT = (
    ("elevation_deg", "deg", "Elevation of the line of sight at the target."),
    ("ground_speed_m_per_s", "m/s", "Ground speed of the subsatellite point."),
    ("velocity_m_per_s", "m/s", "Velocity of the scene across the line of sight."),
    ("gsd_ground_x_m", "m", "Horizontal GSD, projected onto the ground."),
    ("gsd_ground_y_m", "m", "Vertical GSD, projected onto the ground."),
    ("line_rate_Hz", "Hz", "Line rate at which the image moves by one pixel per line."),
)


class Camera(Module, key="camera", title="Camera", group="Optics"):
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
    """

    formulas = (
        Formula(
            r"F=\frac{f}{D},\quad\mathrm{IFOV}=\frac{p}{f},\quad\mathrm{FOV}=2\arctan\frac{Np}{2f}",
            where="f: focal length, D: aperture, mm; p: pitch, µm; N: pixels; IFOV on the axis",
        ),
        Formula(r"\mathrm{GSD}=\frac{p}{f}\,R", where="R: range"),
        Formula(
            r"\Omega=\frac{\pi}{4F^2+1}\left(1-\varepsilon^2\right)\ \mathrm{(disc)},\quad"
            r"\Omega=\frac{\pi}{4F^2}\left(1-\varepsilon^2\right)\ \mathrm{(sine)},\quad"
            r"\tau\,\Omega=\Omega(T,\varepsilon=0)",
            where="Ω: projected solid angle of the optics, sr; ε: obscuration; T: T-number; τ: "
            "transmission",
        ),
        Formula(
            r"v_g=\frac{R_E}{r}\sqrt{\frac{GM}{r}},\quad\cos E=\frac{r}{R_E}\sin\eta,\quad R=r"
            r"\cos\eta-R_E\sin E",
            where="R_E: radius of the Earth; r: R_E plus altitude; v_g: ground speed; "
            "η: look angle; E: elevation; R: range",
        ),
    )

    pixels_x: int | None = param(
        None, "pixels per row", (0, 10**6), unit="pixels", slider=(64, 4096)
    )
    pixels_y: int | None = param(
        None, "pixels per column", (0, 10**6), unit="pixels", slider=(64, 4096)
    )
    pitch_um: float | None = param(None, "horizontal pixel pitch", low=0, slider=(2, 50))
    pitch_y_um: float | None = param(
        None, "vertical pixel pitch; empty: equal to pitch_um", low=0, slider=(2, 50)
    )
    fill_x: float | None = param(None, "horizontal fill factor; empty: 1", (0, 1))
    fill_y: float | None = param(None, "vertical fill factor; empty: 1", (0, 1))
    focal_length_mm: float | None = param(
        None, "focal length; empty: F-number times aperture", low=0, slider=(5, 1000)
    )
    f_number: float | None = param(
        None, "F-number; empty: focal length divided by the aperture", low=0, slider=(0.5, 32)
    )
    aperture_mm: float | None = param(
        None,
        "aperture diameter; empty: focal length divided by the F-number",
        low=0,
        slider=(2, 500),
    )
    obscuration_ratio: float = param(
        0.0,
        "obscuration: inner diameter of the aperture divided by its outer diameter",
        (0, 1),
        below=True,
        slider=(0, 0.6),
    )
    t_number: float | None = param(
        None,
        "T-number: F-number of a lossless, unobscured lens that passes the same amount of "
        "light; empty: from F-number, obscuration and transmission",
        low=0,
        slider=(0.5, 32),
    )
    irradiance: Irradiance = param(
        "disc",
        "how the light depends on the F-number: π/(4F² + 1), or π/(4F²) for a lens that "
        "obeys the sine condition",
    )
    range_m: float | None = param(None, "distance to the scene", low=0, slider=(10, 10000))
    altitude_km: float | None = param(
        None,
        "altitude of a circular orbit; empty: the camera is not on a satellite",
        (0, 1e5),
        above=True,
        slider=(300, 1000),
        zero_is_empty=False,
    )
    look_angle_deg: float = param(
        0.0, "angle of the line of sight off nadir", (0, 89), slider=(0, 50)
    )
    look_direction: ground_geometry.LookDirection = param(
        "across", "direction of the look angle: across the track, or ahead along it"
    )

    panel = (
        Section("Pixels", "pixels_x pixels_y pitch_um pitch_y_um"),
        Section("Fill factors", "fill_x fill_y"),
        Section("Optics", "focal_length_mm f_number aperture_mm obscuration_ratio"),
        Section("Light", "t_number irradiance"),
        Section("Scene", "range_m"),
        Section("Orbit", "altitude_km look_angle_deg look_direction"),
    )

    def run(self, image: Image, here: NodeContext) -> CameraOutputs:
        sheet = self.sheet()
        x, y = intervals_mrad(sheet, image)
        pixel = sheet.pitch_x_mrad, sheet.pitch_y_mrad
        image = replace(image, camera=sheet, pixel_mrad=pixel, interval_x_mrad=x, interval_y_mrad=y)
        how: Any = {"sheet": sheet, "intervals_mrad": (x, y), "band_um": image.band_um}
        table = here.step(camera_figures, **how)
        return CameraOutputs(image, Table(table))

    def sheet(self) -> CameraSheet:
        """The data, of focal length, F-number and aperture the third where two are given."""
        focal, f_number, aperture = self.focal_length_mm, self.f_number, self.aperture_mm
        if focal is None and f_number is not None and aperture is not None:
            focal = f_number * aperture
        if f_number is None and focal is not None and aperture is not None:
            f_number = focal / aperture
        if aperture is None and focal is not None and f_number is not None:
            aperture = focal / f_number
        orbit, range_m = None, self.range_m
        if self.altitude_km is not None:
            orbit = ground_geometry.orbit_view(
                altitude_km=self.altitude_km,
                look_angle_deg=self.look_angle_deg,
                direction=self.look_direction,
            )
            range_m = range_m or orbit.range_m
        values = self.values()
        return CameraSheet(
            pitch_x_um=self.pitch_um,
            pitch_y_um=self.pitch_um if self.pitch_y_um is None else self.pitch_y_um,
            focal_length_mm=focal,
            f_number=f_number,
            aperture_mm=aperture,
            range_m=range_m,
            orbit=orbit,
            **{name: values[name] for name in _GIVEN},
        )

    @warning
    def orbit(self) -> Caution | None:
        """The range contradicts the orbit, the orbit is high, or a look angle needs an orbit."""
        orbit = self.sheet().orbit
        if orbit is not None:
            where = "from altitude and look angle"
            return first(
                apart_caution("range_m", self.range_m, orbit.range_m, where=where),
                _rotation_caution(orbit),
            )
        if not self.look_angle_deg:
            return None
        return Caution(
            f"look_angle_deg = {self.look_angle_deg:g}° is not used: altitude_km is empty",
            "give altitude_km, or set look_angle_deg to 0",
        )

    @warning
    def aperture(self) -> Caution | None:
        """The F-number differs from focal length divided by aperture."""
        if self.focal_length_mm is None or self.aperture_mm is None:
            return None
        return apart(
            self,
            {"f_number": self.focal_length_mm / self.aperture_mm},
            where=f"from {self.focal_length_mm:g} mm / {self.aperture_mm:g} mm",
            near=F_NUMBER_NEAR,
            remedy="leave focal_length_mm, f_number or aperture_mm empty: if all three are "
            "given, diffraction uses the aperture and radiometry uses the F-number",
        )

    @warning
    def light(self) -> Caution | None:
        """The T-number implies more light than a lens with this F-number can pass."""
        sheet = self.sheet()
        if not (sheet.t_number and sheet.f_number):
            return None
        clear = solid_angle(f_number=sheet.t_number, irradiance=sheet.irradiance)
        most = solid_angle(
            f_number=sheet.f_number,
            obscuration_ratio=sheet.obscuration_ratio,
            irradiance=sheet.irradiance,
        )
        if clear <= most * (1 + NEAR):
            return None
        obscured = f" and obscuration_ratio = {sheet.obscuration_ratio:g}"
        return Caution(
            f"t_number = {sheet.t_number:g} is too small for f_number = {sheet.f_number:.4g}"
            f"{obscured if sheet.obscuration_ratio else ''}: the T-number implies a solid angle of "
            f"{clear:.4g} sr, but such a lens without loss has {most:.4g} sr. The T-number is used",
            "correct t_number or f_number; a T-number is larger than the F-number",
        )

    @warning
    def focal_length(self, image: Image) -> Caution | None:
        """The focal length differs from the value in the picture's file."""
        return apart_caution(
            "focal_length_mm",
            self.sheet().focal_length_mm,
            image.header.focal_length_mm,
            where="in the picture's file",
            remedy="the value on Camera is used; correct this value, or use a picture from this "
            "camera",
        )

    @warning
    def field_of_view(self, image: Image) -> Caution | None:
        """The picture's field of view differs from the field of view of the pixels."""
        sheet = self.sheet()
        return first(
            *(
                _field_caution(name, pixels, pitch, interval, samples)
                for name, pixels, pitch, interval, samples in (
                    ("pixels_x", sheet.pixels_x, sheet.pitch_x_mrad,
                     image.interval_x_mrad, image.columns),
                    ("pixels_y", sheet.pixels_y, sheet.pitch_y_mrad,
                     image.interval_y_mrad, image.rows),
                )
            )
        )  # fmt: skip

    @warning
    def pixel_shape(self, outputs: CameraOutputs) -> Caution | None:
        """The samples and the pixels have different aspect ratios."""
        sheet, image = self.sheet(), outputs.image
        if not (sheet.pitch_x_um and sheet.pitch_y_um):
            return None
        if not (image.interval_x_mrad and image.interval_y_mrad):
            return None
        pixel = sheet.pitch_y_um / sheet.pitch_x_um
        sample = image.interval_y_mrad / image.interval_x_mrad
        if alike(pixel, sample):
            return None
        return Caution(
            "samples per pixel differ between horizontal and vertical: the height-to-width ratio "
            f"is {sample:.4g} for the picture's samples and {pixel:.4g} for the pixels",
            "correct pitch, pixels or the picture's field of view; ignore this "
            "warning if this sampling is intended",
        )

    @warning
    def pixels(self, outputs: CameraOutputs) -> Caution | None:
        """The picture has fewer than two samples per pixel."""
        sheet, image = self.sheet(), outputs.image
        for name, pitch, interval in (
            ("wide", sheet.pitch_x_mrad, image.interval_x_mrad),
            ("high", sheet.pitch_y_mrad, image.interval_y_mrad),
        ):
            if pitch and interval and pitch < interval * (1 - NEAR):
                return Caution(
                    f"aliasing cannot be simulated: a sample is {interval:.4g} mrad {name} and a "
                    f"pixel {pitch:.4g} mrad, so the picture's sampling is coarser than the "
                    "camera's",
                    "use a picture with two or more samples per pixel",
                )
            if pitch and interval and pitch < 2 * interval * (1 - NEAR):
                number = f"{pitch / interval:.3g}"
                samples = "1 sample" if number == "1" else f"{number} samples"
                return Caution(
                    f"aliasing is only partly simulated: the picture has {samples} per pixel, "
                    f"and a sample is {interval:.4g} mrad {name}",
                    "use a picture with two or more samples per pixel",
                )
        return None

    figures = TableFigures(
        ("pixel_x_mrad", "mrad", "Horizontal IFOV: pitch over focal length."),
        ("pixel_y_mrad", "mrad", "Vertical IFOV: pitch over focal length."),
        ("fov_x_deg", "deg", "Horizontal field of view."),
        ("fov_y_deg", "deg", "Vertical field of view."),
        ("nyquist_x", "cyc/mrad", "Horizontal Nyquist frequency of the pixels."),
        ("nyquist_y", "cyc/mrad", "Vertical Nyquist frequency of the pixels."),
        ("f_number", "", "F-number."),
        ("aperture_mm", "mm", "Diameter of the aperture."),
        ("samples_per_pixel_x", "samples", "Picture samples per pixel, horizontal."),
        ("samples_per_pixel_y", "samples", "Picture samples per pixel, vertical."),
        ("cutoff", "cyc/mrad", "Diffraction cutoff at the middle wavelength of the band."),
        ("q", "", "λF/pitch: wavelength times F-number over pixel pitch; at 2, the optical cutoff "
         "equals Nyquist."),
        ("gsd_x_m", "m", "Horizontal GSD: width of a pixel's footprint in the scene."),
        ("gsd_y_m", "m", "Vertical GSD: height of a pixel's footprint in the scene."),
        *_ORBIT,
        table=lambda outputs: outputs.camera.recipe,
    )  # fmt: skip


def intervals_mrad(sheet: CameraSheet, image: Image) -> tuple[float | None, float | None]:
    """Angles from sample to sample on the axis, horizontal and vertical.

    They are the picture's own, or the pixels' where it has none. A wide picture whose typed field
    is that of the lens is flat, as the lens pictures it: its samples are not equal angles.
    """
    own = (image.interval_x_mrad, image.interval_y_mrad)
    samples = (image.columns, image.rows)
    pixels = (
        _times(sheet.pixels_x, sheet.pitch_x_mrad),
        _times(sheet.pixels_y, sheet.pitch_y_mrad),
    )
    flat = any(
        interval and width and _is_flat(interval * count, width)
        for interval, width, count in zip(own, pixels, samples, strict=True)
    )
    x, y = (
        width / count if interval is None and width
        else _flattened(interval, count) if interval and flat
        else interval
        for interval, width, count in zip(own, pixels, samples, strict=True)
    )  # fmt: skip
    return x, y


def _is_flat(picture_mrad: float, pixels_mrad: float) -> bool:
    """Whether a field is that of the lens, 2·atan, and not the sum of its pixels' angles."""
    lens = 2000.0 * math.atan(pixels_mrad / 2000.0)
    return alike(picture_mrad, lens) and not alike(picture_mrad, pixels_mrad)


def _flattened(interval_mrad: float, samples: int) -> float:
    half = interval_mrad * samples / 2000.0
    return 2000.0 * math.tan(half) / samples if half < math.pi / 2 else interval_mrad


def _field_caution(
    name: str, pixels: int | None, pitch_mrad: Angle, interval_mrad: Angle, samples: int
) -> Caution | None:
    """By the angle of each pixel, or the tangent of the half field, as wide ones are given too."""
    if not (pixels and pitch_mrad and interval_mrad):
        return None
    picture, camera = interval_mrad * samples, pixels * pitch_mrad
    degrees = math.degrees(picture / 1000)
    flat = field_of_view_deg(pixels=pixels, pixel_mrad=pitch_mrad)
    if alike(picture, camera) or alike(degrees, flat):
        return None
    return Caution(
        f"the picture's field of view, {degrees:.4g}°, is used, but {name} = {pixels} at "
        f"{pitch_mrad:.4g} mrad per pixel gives {flat:.4g}°",
        "correct pixels, pitch, focal length or the picture's field of view; ignore "
        "this warning if the picture covers more or less than the camera's field",
    )


Band = tuple[float, float]


def camera_figures(
    work: Work, *, sheet: CameraSheet, intervals_mrad: tuple[Angle, Angle], band_um: Band | None
) -> TableData:
    x, y = sheet.pitch_x_mrad, sheet.pitch_y_mrad
    middle = None if band_um is None else sum(band_um) / 2
    blur = _times(middle, sheet.f_number)
    gsd = _over(_times(x, sheet.range_m), 1000.0), _over(_times(y, sheet.range_m), 1000.0)
    return Camera.figures.table(
        ("pixels_x", sheet.pixels_x, "pixels", "pixels per row"),
        ("pixels_y", sheet.pixels_y, "pixels", "pixels per column"),
        ("pitch_x_um", sheet.pitch_x_um, "µm", "horizontal pixel pitch"),
        ("pitch_y_um", sheet.pitch_y_um, "µm", "vertical pixel pitch"),
        ("focal_length_mm", sheet.focal_length_mm, "mm", "focal length"),
        ("f_number", sheet.f_number),
        ("aperture_mm", sheet.aperture_mm),
        ("obscuration_ratio", sheet.obscuration_ratio, "",
         "obscuration: inner over outer diameter of the aperture"),
        ("fill_x", sheet.fill_x or 1.0, "", "horizontal fill factor"),
        ("fill_y", sheet.fill_y or 1.0, "", "vertical fill factor"),
        ("range_m", sheet.range_m, "m", "distance to the scene"),
        ("pixel_x_mrad", x),
        ("pixel_y_mrad", y),
        ("fov_x_deg", _field_deg(sheet.pixels_x, x)),
        ("fov_y_deg", _field_deg(sheet.pixels_y, y)),
        ("nyquist_x", _over(0.5, x)),
        ("nyquist_y", _over(0.5, y)),
        ("samples_per_pixel_x", _over(x, intervals_mrad[0])),
        ("samples_per_pixel_y", _over(y, intervals_mrad[1])),
        ("cutoff", _over(sheet.aperture_mm, middle)),
        ("q", _over(blur, sheet.pitch_x_um)),
        ("gsd_x_m", gsd[0]),
        ("gsd_y_m", gsd[1]),
        *_orbit_rows(sheet.orbit, *gsd),
    )  # fmt: skip


def _rotation_caution(orbit: ground_geometry.OrbitView) -> Caution | None:
    if orbit.altitude_km <= _LOW_ORBIT_KM:
        return None
    share = 100.0 * _EARTH_M_PER_S / orbit.ground_speed_m_per_s
    return Caution(
        f"the scene's velocity is wrong by up to {share:.0f} %: at altitude_km = "
        f"{orbit.altitude_km:g} the Earth's rotation, neglected here, is {share:.0f} % of "
        "the ground speed",
        "enter the true velocity_m_per_s on Init & Trans",
    )


def _orbit_rows(
    orbit: ground_geometry.OrbitView | None, gsd_x_m: float | None, gsd_y_m: float | None
) -> list[tuple[str, float | None]]:
    values: list[float | None] = [None] * len(_ORBIT)
    if orbit is not None:
        velocity, ground = orbit.velocity_m_per_s, orbit.ground_gsd(gsd_x_m, gsd_y_m)
        rate = _over(velocity, gsd_y_m)
        values = [orbit.elevation_deg, orbit.ground_speed_m_per_s, velocity, *ground, rate]
    return [(name, value) for (name, _, _), value in zip(_ORBIT, values, strict=True)]


def _times(a: float | None, b: float | None) -> float | None:
    return None if a is None or b is None else a * b


def _over(a: float | None, b: float | None) -> float | None:
    return None if a is None or not b else a / b


def _field_deg(pixels: int | None, pitch_mrad: float | None) -> float | None:
    if pixels is None or pitch_mrad is None:
        return None
    return field_of_view_deg(pixels=pixels, pixel_mrad=pitch_mrad)
