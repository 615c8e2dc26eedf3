"""What a linear change says of itself."""

from core.chain.linear_change import Linear


class Filtered(Linear):
    """A change whose noise is not one factor times that before it."""

    def noise(self, _work, power):
        return power.scaled(0.5)


class Carried(Linear):
    def carried(self, *given, **named):
        return super().carried(*given, **named)


def test_only_a_change_that_leaves_noise_and_signal_to_one_factor_is_by_sample():
    assert Linear().by_sample
    assert not Filtered().by_sample
    assert not Carried().by_sample
