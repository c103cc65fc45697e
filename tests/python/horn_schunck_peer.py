"""Horn and Schunck's optical flow as one would write it with NumPy, for comparison.

Two ways to take the local means: with NumPy alone, and with OpenCV's filter, which is faster.
"""
import cv2
import numpy

MEANS = numpy.array([[1, 2, 1], [2, 0, 2], [1, 2, 1]], numpy.float32) / 12


def derivatives(first, second):
    """E_x, E_y and E_t of the thesis's eqs. 2.29 to 2.31; the last row and column are repeated."""
    a, b = (numpy.pad(picture, ((0, 1), (0, 1)), mode="edge") for picture in (first, second))
    cube = [picture[y : y + first.shape[0], x : x + first.shape[1]] for picture in (a, b) for y in (0, 1) for x in (0, 1)]
    upper, upper_right, lower, lower_right, next_upper, next_upper_right, next_lower, next_lower_right = cube
    x = upper_right - upper + lower_right - lower + next_upper_right - next_upper + next_lower_right - next_lower
    y = lower - upper + lower_right - upper_right + next_lower - next_upper + next_lower_right - next_upper_right
    t = next_upper - upper + next_lower - lower + next_upper_right - upper_right + next_lower_right - lower_right
    return x / 4, y / 4, t / 4


def means_by_filter(flow, means):
    """Eqs. 2.33, 2.34 by OpenCV's filter."""
    cv2.filter2D(flow, -1, MEANS, means, borderType=cv2.BORDER_REPLICATE)


def means_by_numpy(flow, means):
    """Eqs. 2.33, 2.34 by sums of shifted arrays: 1, 2, 1 down the columns, then along the rows."""
    padded = numpy.pad(flow, 1, mode="edge")
    columns = padded[:-2] + padded[2:]
    columns += padded[1:-1]
    columns += padded[1:-1]
    numpy.add(columns[:, :-2], columns[:, 2:], out=means)
    means += columns[:, 1:-1]
    means += columns[:, 1:-1]
    means -= 4 * flow
    means /= 12


def horn_schunck(first, second, alpha, iterations, take_means=means_by_filter):
    """u and v after so many iterations of eqs. 2.36 and 2.37, without a new array or a division in any of them."""
    e_x, e_y, e_t = derivatives(first, second)
    factor = 1 / numpy.sqrt(numpy.float32(alpha) ** 2 + e_x * e_x + e_y * e_y)
    e_x, e_y, e_t = e_x * factor, e_y * factor, e_t * factor
    u, v, u_mean, v_mean, error, product = (numpy.zeros_like(first) for _ in range(6))
    for _ in range(iterations):
        take_means(u, u_mean)
        take_means(v, v_mean)
        numpy.multiply(e_x, u_mean, out=error)
        numpy.multiply(e_y, v_mean, out=product)
        error += product
        error += e_t
        numpy.multiply(e_x, error, out=product)
        numpy.subtract(u_mean, product, out=u)
        numpy.multiply(e_y, error, out=product)
        numpy.subtract(v_mean, product, out=v)
    return u, v
