"""Figures of Merit: what a sensor resolves and detects, and how far."""

import math
from typing import Any, Literal, NamedTuple

from core.chain.wires import Context, Curve, Image, Table
from core.errors import DataError
from core.modules.declaration import Caution, Formula, Module, NodeContext, Section, param, warning
from core.physics.acquisition.mrtd import Window
from core.physics.acquisition.target_acquisition import frames_integrated
from core.physics.atmosphere.air_path import AirPath
from core.physics.detector.photon_conversion import SHORTEST_THERMAL_UM
from core.records import replace
from core.transfer.factors import Grid
from nodes.analysis import threshold_curves
from nodes.analysis.lineage import NoiseOf, transfer_of
from nodes.shared.context_defaults import (
    NEAR,
    Band,
    alike,
    band_warning,
    given_band,
    unit_caution,
    with_interval,
)
from nodes.shared.module_ports import CutOff, CutOn

Scanning = Literal["automatic", "parallel_scan", "serial_scan", "staring"]

_OF_PLATFORM: dict[str, Scanning] = {
    "line": "serial_scan",
    "push": "parallel_scan",
    "array": "staring",
}


class MeritOutputs(NamedTuple):
    mrtd: Curve
    mdtd: Curve
    probability: Curve
    table: Table


class FiguresOfMerit(Module, key="figures_of_merit", title="Figures of Merit", group="Analysis"):
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
    """

    formulas = (
        Formula(
            r"\mathrm{MRTD}(f)=\frac{\pi^2}{8}\;\frac{\mathrm{SNR}_{th}\,\sigma_p(f)}{H(f)}",
            where="σ_p: perceived noise in K, averaged by the eye over a bar (1/(2f) "
            "by 7/(2f)) and over time; H: MTF of the chain",
        ),
        Formula(
            r"\mathrm{MDTD}(W)=\frac{\mathrm{SNR}_{th}\,\sigma_p(w)}{\overline{I}(W,w)}",
            where="W: side of the square target; Ī: fraction of the target's contrast that remains "
            "in a window of side w",
        ),
        Formula(
            r"P=\frac{r^E}{1+r^E},\quad r=\frac{N}{N_{50}},\quad E=2.7+0.7\,r",
            where="N: cycles across the target",
            when="Johnson",
        ),
        Formula(
            r"V=\frac{\sqrt{A}}{R}\int\sqrt{\frac{C}{C_{th}(f)}}\;df",
            where="A: target area; C: target contrast; R: range; C_th: contrast threshold of "
            "sensor and eye",
            when="TTP",
        ),
        Formula(r"P=\frac{r^E}{1+r^E},\quad r=\frac{V}{V_{50}},\quad E=1.51+0.24\,r", when="TTP"),
    )

    model: threshold_curves.Model = param(
        "flir92",
        "MRTD model: temporal noise only (ratches_1976), or 3-D noise with a "
        "sampling limit (flir92)",
    )
    scanning: Scanning = param(
        "automatic",
        "how the picture is scanned; automatic: from Init & Trans's platform (line: "
        "serial, push: parallel, array: staring)",
    )
    cut_on_um: CutOn = None
    cut_off_um: CutOff = None
    background_K: float | None = param(
        None, "background temperature; empty: brightness temperature of the picture's mean", low=0
    )
    snr_threshold: float = param(
        2.5,
        "SNR at which half of the observers resolve the bars or detect the target",
        (0, 1000),
        above=True,
        slider=(1, 5),
    )
    frame_rate_Hz: float | None = param(
        30.0, "frames per second; empty: a single still frame", low=0, slider=(0, 120)
    )
    eye_integration_s: float = param(
        0.2, "time over which the eye averages frames", (0, 10), above=True
    )
    mdtd_window: Window = param(
        "target", "MDTD: whether the eye averages over the target or over its blurred image"
    )
    eye_limit_mrad: float | None = param(
        None,
        "MDTD: largest angle in the scene over which the eye averages; empty: no limit",
        low=0,
        slider=(0, 100),
    )
    target_size_m: float = param(
        2.3,
        "characteristic dimension of the target: the square root of its area",
        (0, 1e6),
        above=True,
        slider=(0.1, 10),
    )
    target_delta_K: float = param(
        2.0, "temperature difference between target and background", (-10000, 10000), slider=(0, 10)
    )
    extinction_per_km: float = param(
        0.2,
        "extinction coefficient of the air in the band, used if there is no Atmospheric Path",
        (0, 1e6),
        slider=(0, 2),
    )
    n50_detection: float = param(
        0.75,
        "cycles across the target for 50 % detection with the 2-D MRTD (1 with the 1-D MRTD)",
        (0, 1000),
        above=True,
        slider=(0.1, 10),
    )
    n50_recognition: float = param(
        3.0,
        "cycles across the target for 50 % recognition with the 2-D MRTD (4 with the 1-D MRTD)",
        (0, 1000),
        above=True,
        slider=(0.1, 10),
    )
    n50_identification: float = param(
        6.0,
        "cycles across the target for 50 % identification with the 2-D MRTD (6.4 with the 1-D "
        "MRTD)",
        (0, 1000),
        above=True,
        slider=(0.1, 10),
    )
    ttp_threshold: threshold_curves.TtpForm = param(
        "mrtd",
        "TTP: contrast threshold from the eye and the MRTD, or the published "
        "threshold from MTF and noise",
    )
    v50: float = param(
        18.8,
        "TTP value for 50 % success; use published values with system_contrast_threshold",
        (0, 10000),
        above=True,
        slider=(1, 40),
    )
    scene_contrast_K: float = param(
        5.0,
        "TTP: temperature difference that corresponds to the mean luminance of the display",
        (0, 1e4),
        above=True,
        slider=(0.5, 20),
    )
    display_cd_m2: float = param(
        34.0,
        "TTP: mean luminance of the display",
        (0, 1e6),
        unit="cd/m²",
        above=True,
        slider=(1, 300),
    )
    display_deg: float = param(
        15.0,
        "TTP: angle that the display subtends at the eye",
        (0, 180),
        above=True,
        slider=(1, 60),
    )
    magnification: float | None = param(
        None,
        "TTP: magnification, angle on the display / angle in the scene; empty: the picture "
        "fills the display",
        low=0,
        slider=(0, 20),
    )
    range_max_km: float | None = param(
        None,
        "longest range on the curve; empty: automatic, the range at which the probability of "
        "detection is 10 % (Johnson) or of success 50 % (TTP), whichever is longer",
        (0, 1e6),
        slider=(0, 20),
    )

    panel = (
        Section("", "model scanning snr_threshold", page="Sensor"),
        Section("Noise", "cut_on_um cut_off_um background_K", page="Sensor"),
        Section("In time", "frame_rate_Hz eye_integration_s", page="Eye"),
        Section("MDTD", "mdtd_window eye_limit_mrad", page="Eye"),
        Section(
            "Target", "target_size_m target_delta_K extinction_per_km range_max_km", page="Target"
        ),
        Section("Johnson", "n50_detection n50_recognition n50_identification", page="Target"),
        Section("Task and scene", "ttp_threshold v50 scene_contrast_K", page="TTP"),
        Section("Display", "display_cd_m2 display_deg magnification", page="TTP"),
    )

    def run(self, context: Context, image: Image, here: NodeContext) -> MeritOutputs:
        image = with_interval(image, context)
        known = image.band_um or context.band_um
        passed, grid, node = transfer_of(image, of_camera=True), image.grid(), here.node
        sensor: Any = {"stages": passed.part("mtf"), "grid": grid, "model": self.model}
        sensor |= {"snr_threshold": self.snr_threshold, "frames": self._frames()}
        window = {"window": self.mdtd_window, "eye_limit_mrad": self.eye_limit_mrad}
        band_um = given_band(self.cut_on_um, self.cut_off_um, known)
        shortest = (known or band_um)[0]
        if shortest < SHORTEST_THERMAL_UM and self.background_K is None:
            raise DataError(
                f"the band begins at {shortest:g} µm, where the signal is reflected light, which "
                "has no temperature. NETD, MRTD, MDTD and the ranges derived from them do not "
                "apply. Use Image Quality, or give background_K for a scene hot enough to emit in "
                "this band"
            )
        seen = here.step(
            threshold_curves.sensitivity,
            NoiseOf(image, node, uniform=True),
            *passed.levels,
            gain=passed.gain,
            gain_before=passed.gain_before,
            band_um=band_um,
            background_K=self.background_K,
        )
        sampled = self._sampled(context)
        threshold_step = here.step(threshold_curves.thresholds, seen, sampled=sampled, **sensor)
        task = self._task(grid, _air(image, context), band_um)
        reached = here.step(
            threshold_curves.acquisition, threshold_step, seen, task=task, grid=grid
        )
        merit: Any = {"grid": grid, "unit": image.unit, "frames": self._frames()}
        table = here.step(threshold_curves.merit_table, seen, threshold_step, reached, **merit)
        return MeritOutputs(
            Curve(here.step(threshold_curves.mrtd_curve, threshold_step)),
            Curve(here.step(threshold_curves.mdtd_curve, seen, **sensor, **window)),
            Curve(here.step(threshold_curves.probability_curve, reached)),
            Table(table),
        )

    band = band_warning

    @warning
    def unit(self, image: Image) -> Caution | None:
        """The picture is not in radiance units, and its chain has no conversion from radiance."""
        if image.interval_x_mrad is not None and transfer_of(image, of_camera=True).levels:
            return None
        return unit_caution(image.unit, meant="NETD, MRTD and MDTD")

    @warning
    def extinction(self, image: Image, given: frozenset[str]) -> Caution | None:
        """An extinction coefficient is given, but an Atmospheric Path sets the transmission."""
        if "extinction_per_km" not in given or not image.air:
            return None
        paths = [air for air in image.air if air.is_grey and air.range_m]
        if len(paths) == len(image.air):
            of_path = sum(1000.0 * float(air.depth_per_m(1.0)) for air in paths)
            if alike(self.extinction_per_km, of_path):
                return None
        return Caution(
            f"extinction_per_km = {self.extinction_per_km:g} 1/km is not used: the ranges are "
            "computed with the transmission of the Atmospheric Path before this node",
            "clear extinction_per_km here, or set the extinction on Atmospheric Path",
        )

    @warning
    def timing(self, image: Image, context: Context) -> Caution | None:
        """The frame rate differs from the detector's, or the exposure is longer than a frame."""
        rate, exposure_s = self.frame_rate_Hz, image.exposure_s
        if rate is None:
            return None
        if image.frame_rate_Hz is not None and not alike(rate, image.frame_rate_Hz):
            return Caution(
                f"frame_rate_Hz = {rate:g} Hz here but {image.frame_rate_Hz:g} Hz on "
                "Microbolometer",
                "use the same frame rate on both nodes, or link one parameter to the other",
            )
        if exposure_s is None or context.platform != "array" or exposure_s * rate <= 1 + NEAR:
            return None
        return Caution(
            f"the exposure is longer than a frame: integration_time_s is {1000 * exposure_s:.4g} "
            f"ms, but a frame lasts {1000 / rate:.4g} ms at frame_rate_Hz = {rate:g} Hz",
            "lower frame_rate_Hz or integration_time_s",
        )

    def _frames(self) -> float:
        if self.frame_rate_Hz is None:
            return 1.0
        return frames_integrated(
            frame_rate_Hz=self.frame_rate_Hz, eye_integration_s=self.eye_integration_s
        )

    def _sampled(self, context: Context) -> tuple[bool, bool]:
        scanning = self.scanning
        if scanning == "automatic":
            scanning = _OF_PLATFORM[context.platform]
        along_flight = scanning == "parallel_scan" and context.platform == "push"
        return scanning == "staring" or along_flight, not along_flight

    def _task(self, grid: Grid, air: tuple[AirPath, ...], band_um: Band) -> threshold_curves.Task:
        field_deg = math.degrees(grid.columns * grid.interval_x_mrad / 1000.0)
        return threshold_curves.Task(
            size_m=self.target_size_m,
            delta_K=self.target_delta_K,
            extinction_per_km=self.extinction_per_km,
            n50=(self.n50_detection, self.n50_recognition, self.n50_identification),
            v50=self.v50,
            scene_contrast_K=self.scene_contrast_K,
            luminance_cd_m2=self.display_cd_m2,
            display_deg=self.display_deg,
            magnification=self.magnification or self.display_deg / field_deg,
            range_max_km=self.range_max_km,
            ttp_threshold=self.ttp_threshold,
            seconds_per_frame=self.eye_integration_s / self._frames(),
            seconds_fixed=self.eye_integration_s if self.model == "flir92" else 0.0,
            air=air,
            band_um=band_um,
        )

    figures = threshold_curves.FIGURES


def _air(image: Image, context: Context) -> tuple[AirPath, ...]:
    """The path that the picture has come through; its range of Init & Trans where it has none."""
    paths = tuple(
        air if air.range_m else replace(air, range_m=context.range_m) for air in image.air
    )
    if any(air.range_m is None for air in paths):
        raise DataError(
            "Atmospheric Path has a transmission but no range, so the transmission at other "
            "ranges is unknown: give range_m on Atmospheric Path, Camera or Init & Trans"
        )
    return paths
