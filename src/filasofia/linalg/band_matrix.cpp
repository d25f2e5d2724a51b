#include "filasofia/linalg/band_matrix.h"

#include <algorithm>
#include <cmath>

namespace filasofia::linalg {
namespace {

constexpr std::size_t kWidth = BandMatrix::kWidth;

} // namespace

void BandMatrix::multiply(std::span<const double> x, std::span<double> y) const
{
    std::fill(y.begin(), y.end(), 0.0);
    for (std::size_t j = 0; j < rows_; ++j) {
        const double* a = column(j);
        const std::size_t end = std::min(kWidth, rows_ - 1 - j);
        double sum = a[0] * x[j];
        for (std::size_t k = 1; k <= end; ++k) {
            y[j + k] += a[k] * x[j];
            sum += a[k] * x[j + k];
        }
        y[j] += sum;
    }
}

bool BandCholesky::factorise(const BandMatrix& matrix)
{
    lower_ = matrix;
    for (std::size_t j = 0; j < lower_.rows(); ++j) {
        double* column = lower_.column(j);
        if (!(column[0] > 0.0) || !std::isfinite(column[0])) return false;
        const double inverse = 1.0 / std::sqrt(column[0]);
        column[0] = inverse;
        for (std::size_t k = 1; k <= kWidth; ++k) column[k] *= inverse;
        // What the columns to the right lose. Beyond the last row there are zeros.
        for (std::size_t c = 1; c <= kWidth; ++c) {
            double* right = lower_.column(j + c);
            const double factor = column[c];
            for (std::size_t k = 0; k + c <= kWidth; ++k) right[k] -= factor * column[c + k];
        }
    }
    work_.assign(lower_.rows() + kWidth, 0.0);
    return true;
}

void BandCholesky::solve(std::span<double> x) const
{
    const std::size_t rows = lower_.rows();
    std::copy(x.begin(), x.end(), work_.begin());
    std::fill(work_.begin() + static_cast<std::ptrdiff_t>(rows), work_.end(), 0.0);
    for (std::size_t j = 0; j < rows; ++j) {
        const double* column = lower_.column(j);
        double* at = &work_[j];
        const double known = at[0] *= column[0];
        for (std::size_t k = 1; k <= kWidth; ++k) at[k] -= known * column[k];
    }
    std::fill(work_.begin() + static_cast<std::ptrdiff_t>(rows), work_.end(), 0.0);
    for (std::size_t j = rows; j-- > 0;) {
        const double* column = lower_.column(j);
        double* at = &work_[j];
        double sum = at[0];
        for (std::size_t k = 1; k <= kWidth; ++k) sum -= column[k] * at[k];
        at[0] = sum * column[0];
    }
    std::copy_n(work_.begin(), rows, x.begin());
}

void BandCholesky::invert(BandMatrix& inverse) const
{
    inverse.resize(lower_.rows());
    for (std::size_t j = lower_.rows(); j-- > 0;) {
        // With U = L D^-1, whose diagonal is 1: A^-1 = D^-2 U^-1 + (1 - U^T) A^-1, of which the lower half needs no
        // U^-1.
        const double* column = lower_.column(j);
        double* out = inverse.column(j);
        double own = column[0] * column[0];
        for (std::size_t row = 1; row <= kWidth; ++row) {
            double sum = 0.0;
            for (std::size_t k = 1; k <= kWidth; ++k)
                sum -= column[k] * (row >= k ? inverse.column(j + k)[row - k] : inverse.column(j + row)[k - row]);
            out[row] = sum * column[0];
        }
        for (std::size_t k = 1; k <= kWidth; ++k) own -= column[k] * column[0] * out[k];
        out[0] = own;
    }
}

} // namespace filasofia::linalg
