"""A network that reads a cube of all bands, filters it and counts its electrons."""

from core.network.file import format_network
from cube_files import centres, materials_cube, write_cube
from linked_network import linked_network

BANDS = 12
SIZE = (24, 40)


def cube_samples(unit_low=3.0, unit_high=5.0):
    """The cube, its wavelengths and the width of a band."""
    wavelengths, width = centres(BANDS, low=unit_low, high=unit_high)
    return materials_cube(SIZE, wavelengths), wavelengths, width


def write_cube_network(
    folder, library, *, kind="f8", unit="W/m^2/sr/um", focal_plane=None, aperture_mm=25.0
):
    """Write the cube and the network's file; give the cube, its wavelengths, a band's width."""
    cube, wavelengths, width = cube_samples()
    write_cube(folder, cube, wavelengths, width, kind=kind, unit=unit)
    well = {"full_well_e": 7e6, "integration_time_s": 0.004, "bits": 14}
    sensor = {"focal_length_mm": 100.0, "f_number": 100.0 / aperture_mm}
    sensor |= {"detector_x_um": 15, "detector_y_um": 15}
    read = {"path": "cube.img", "bands": "all", "fov_x_deg": 0.08, "fov_y_deg": 0.048}
    nodes = {
        "read": ("read_image", read),
        "init": ("init_trans", sensor),
        "optics": ("diffraction_mtf", {"aperture_mm": aperture_mm}),
        "back": ("back_transform", {}),
        "fpa": ("focal_plane", {**well, **(focal_plane or {})}),
    }
    network = linked_network(nodes)
    (folder / "cube.json").write_text(format_network(network, library=library))
    return cube, wavelengths, width
