"""What a module must hold to: ours do, and one that does not is named with what is wrong."""

import itertools
from dataclasses import dataclass
from typing import Annotated

import numpy as np
import pytest

from core.chain.step_lineage import Linear, picture_step
from core.chain.wires import Context, Image, Magnitude
from core.evaluation.recipes import Step, pointwise
from core.modules.declaration import Module, NodeContext, readout
from core.modules.parameters import Param
from nodes.library import our_module
from nodes.module_battery import check_module, faults_of
from nodes.shared.module_ports import ImageOutput, MtfModule, MtfOutputs, radial

COUNTER = itertools.count()
GAIN = Annotated[float, Param("gain", low=0, high=10)]


@pytest.mark.parametrize(
    ("key", "example"),
    [
        ("gaussian_mtf", {"sigma_x_mrad": 1, "sigma_y_mrad": 2}),
        ("charge_eff_phase", {"efficiency": 0.999}),
        ("poisson_noise", {"percent": 50}),
        ("combine_pixels", {"factor_x": 3, "factor_y": 2}),
        ("noise_budget", {}),
    ],
)
def test_of_ours_nothing_is_said(key, example):
    module = our_module(key)
    check_module(module, examples=(example,))


class _Image(Module):
    def run(self, image: Image, here: NodeContext) -> ImageOutput:
        """Plan it."""
        made = Step.of(self.step, image.recipe, node=here.node, **self.bound())
        return ImageOutput(image.with_recipe(made))

    def bound(self):
        return {}


@pointwise
def undeclared(work, image):
    return image * 2


@picture_step()
@pointwise
def doubled(work, image):
    return image * 2


@picture_step()
@pointwise
def forgetful(work, image):
    return image * Forgetful.now


@picture_step()
@pointwise
def infinite(work, image):
    return image / np.zeros_like(image)


@picture_step()
@pointwise
def rough(work, image):
    return image if work.policy.dtype == np.float64 else np.round(image)


@picture_step()
@pointwise
def by_part(work, image):
    return image - image.min()


@picture_step()
@pointwise
def counted(work, image, *, number):
    return image + number


@picture_step()
@pointwise
def failing(work, image):
    raise IndexError("list index out of range")


def module_of(a_step):
    """A module of one step, called as that."""

    class Made(_Image, key=f"a.{a_step.__name__}", title="Made", group="A"):
        """Does the step."""

        step = staticmethod(a_step)

    Made.__name__ = a_step.__name__
    return Made


class Forgetful(_Image, key="a.forgetful", title="Forgetful", group="A"):
    """A parameter that does not reach the recipe."""

    now = 1.0
    step = staticmethod(forgetful)
    gain: GAIN = 1.0

    def bound(self):
        type(self).now = self.gain
        return {}


class Restless(_Image, key="a.restless", title="Restless", group="A"):
    """Each plan is another one."""

    step = staticmethod(counted)

    def bound(self):
        return {"number": next(COUNTER)}


@dataclass(frozen=True)
class Careless(Linear):
    """What becomes of noise in a step that is careless about it."""

    factor: float | None

    def noise(self, work, power):  # noqa: ARG002  (as the engine calls it)
        return power.scaled(1.0 * self.factor)


@picture_step(linear=lambda image, *, factor: Careless(factor))  # noqa: ARG005
@pointwise
def passed_on(work, image, *, factor):
    return image


class NoNoise(_Image, key="a.no_noise", title="No Noise", group="A"):
    """Fails where noise comes."""

    step = staticmethod(passed_on)

    def bound(self):
        return {"factor": None}


class BadNoise(_Image, key="a.bad_noise", title="Bad Noise", group="A"):
    """Makes noise that is no number."""

    step = staticmethod(passed_on)

    def bound(self):
        return {"factor": float("inf")}


class Silent(_Image, key="a.silent", title="Silent", group="A"):
    step = staticmethod(forgetful)
    gain: Annotated[float, Param("A gain.", low=0)] = 1.0

    @readout()
    def level(self):
        return float("nan")


class Loud(MtfModule, key="a.loud", title="Loud", group="A"):
    """More contrast than there is."""

    def run(
        self,
        context: Context,  # noqa: ARG002  (an input that it must have)
        magnitude: Magnitude,
        here: NodeContext,
    ) -> MtfOutputs:
        """Plan it."""
        return self.mtf_outputs(magnitude, *radial(amplified, node=here.node))


def amplified(*, rho):
    return 1.5 + 0 * np.asarray(rho)


class Untyped(Module, key="a.untyped", title="Untyped", group="A"):
    """A parameter that says nothing of itself."""

    gain: float = 1.0

    def run(self, image: Image) -> ImageOutput:
        """Plan it."""
        return ImageOutput(image)


@pytest.mark.parametrize(
    ("module", "words"),
    [
        (module_of(undeclared), ["undeclared does not state how it changes a picture"]),
        (Forgetful, ["output image changes with gain = 1.37, but its key does not"]),
        (
            module_of(doubled),
            ["a change in the scene is multiplied by 2, but the step states a gain of 1"],
        ),
        (NoNoise, ["TypeError instead of an ImagechainError: unsupported operand"]),
        (BadNoise, ["output image: noise of variance 1 gives a variance of inf"]),
        (module_of(infinite), ["does not run: it: numbers overflow the floating-point range"]),
        (module_of(rough), ["output image in single precision differs", "of the range"]),
        (module_of(by_part), ["a region computed on its own", "differs from the full picture by"]),
        (Restless, ["a different key each time"]),
        (module_of(failing), ["IndexError instead of an ImagechainError: list index"]),
        (Silent, ["no docstring", "gain: the help text must not end", "read-out level is nan"]),
        (Loud, ["H(0) = ", "|H| reaches 1.5"]),
        (Untyped, ["declaration: Untyped.gain needs param"]),
    ],
)
def test_what_does_not_hold_is_named(module, words):
    with np.errstate(all="ignore"):
        faults = faults_of(module)
    for word in words:
        assert any(word in fault for fault in faults), (word, faults)
    assert not any("\n" in fault for fault in faults)
    if len(words) == 1:
        assert len(faults) == 1 or module.__name__ in ("failing", "Restless"), faults
    with pytest.raises(AssertionError, match=module.__name__), np.errstate(all="ignore"):
        check_module(module)
