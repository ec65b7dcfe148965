"""Intervals and bounds at 95 % from samples."""

import numpy
import scipy.stats


def bound_of_none(count):
    """The largest share that is compatible at 95 % with none in `count` independent trials (one-sided, exact): about 3 / count."""
    return 1 - 0.05 ** (1 / count)


def none_of(count, what):
    """'0 of 1,000 crossings, so fewer than 0.3 % at 95 % confidence'."""
    return f"0 of {count:,} {what}, so a share below {bound_of_none(count):.2g} at 95 % confidence"


def quantile(values, share):
    """One of the values, so that this share of them is not larger; NaN for none."""
    return float(numpy.quantile(values, share, method="inverted_cdf")) if len(values) else numpy.nan


def bootstrap(values, statistic=numpy.median):
    """(statistic, low, high): percentiles of 2000 resamples with replacement."""
    values = numpy.asarray(values)[~numpy.isnan(values)]
    if len(values) < 2 or numpy.ptp(values) == 0:
        found = float(statistic(values)) if len(values) else numpy.nan
        return found, found, found
    interval = scipy.stats.bootstrap((values,), statistic, n_resamples=2000, method="percentile",
                                     random_state=numpy.random.default_rng(1),
                                     vectorized=False).confidence_interval
    return float(statistic(values)), float(interval.low), float(interval.high)


def ratio_of_means(times, others, weights=None):
    """(ratio, low, high) of the mean times of two that took turns in passes, (passes, pieces) each. The time of a piece is the median of
    its passes, because other work on the machine interrupts some of them. The passes are resampled. A time counts as twice its piece's
    median at most, so that an interruption that is drawn often stays a small one."""
    def mean(passes):
        return numpy.average(numpy.median(passes, axis=0), weights=weights)

    times, others = (numpy.minimum(passes, 2 * numpy.median(passes, axis=0)) for passes in (times, others))
    return bootstrap(numpy.arange(len(times)), lambda picked: mean(times[picked]) / mean(others[picked]))


def in_words(values, form="{:.3g}", statistic=numpy.median):
    """'0.31 [0.28, 0.35]'."""
    return "{0} [{1}, {2}]".format(*map(form.format, bootstrap(values, statistic)))
