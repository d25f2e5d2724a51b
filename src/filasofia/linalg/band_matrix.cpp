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
    if (!cyclic_) return;
    for (std::size_t r = 0; r < kCorner; ++r)
        for (std::size_t c = 0; c < kCorner; ++c) {
            y[rows_ - kCorner + r] += corner(r, c) * x[c];
            y[c] += corner(r, c) * x[rows_ - kCorner + r];
        }
}

bool BandCholesky::factorise(const BandMatrix& matrix)
{
    rows_ = matrix.rows();
    border_.clear();
    if (matrix.cyclic())
        takeApart(matrix);
    else
        lower_ = matrix;
    if (!factoriseBand(lower_.columns(), lower_.rows())) return false;
    for (std::size_t j = 0; !border_.empty() && j < lower_.rows(); ++j) eliminate(j);
    work_.assign(lower_.rows() + kBandColumn, 0.0);
    return border_.empty() || factoriseBorder();
}

/// Divides a cyclic matrix into the band, the border's rows and the border's own block.
void BandCholesky::takeApart(const BandMatrix& matrix)
{
    const std::size_t inner = rows_ - kBorder;
    lower_.resize(inner);
    border_.assign(inner + kWidth, {}); // further columns of zeros, as the band has them
    for (std::size_t j = 0; j < inner; ++j)
        for (std::size_t k = 0; k <= kWidth && j + k < rows_; ++k)
            (j + k < inner ? lower_.column(j)[k] : border_[j][j + k - inner]) = matrix.column(j)[k];
    for (std::size_t r = 0; r < kBorder; ++r)
        for (std::size_t c = 0; c < kBorder; ++c) {
            border_[c][r] += matrix.corner(r, c);
            corner_[r][c] = matrix.entry(inner + r, inner + c);
        }
}

/// Column j of the border's rows, and what the border's part of the columns to the right loses.
void BandCholesky::eliminate(std::size_t j)
{
    const double* column = lower_.column(j);
    Border& own = border_[j];
    for (double& each : own) each *= column[0]; // over the entry of L on the diagonal
    for (std::size_t c = 1; c <= kWidth; ++c)
        for (std::size_t r = 0; r < kBorder; ++r) border_[j + c][r] -= column[c] * own[r];
    for (std::size_t r = 0; r < kBorder; ++r)
        for (std::size_t c = 0; c <= r; ++c) corner_[r][c] -= own[r] * own[c];
}

bool BandCholesky::factoriseBorder()
{
    for (std::size_t j = 0; j < kBorder; ++j) {
        if (!(corner_[j][j] > 0.0) || !std::isfinite(corner_[j][j])) return false;
        corner_[j][j] = 1.0 / std::sqrt(corner_[j][j]);
        for (std::size_t r = j + 1; r < kBorder; ++r) corner_[r][j] *= corner_[j][j];
        for (std::size_t r = j + 1; r < kBorder; ++r)
            for (std::size_t c = j + 1; c <= r; ++c) corner_[r][c] -= corner_[r][j] * corner_[c][j];
    }
    return true;
}

void BandCholesky::solveBorder(Border& x) const
{
    for (std::size_t r = 0; r < kBorder; ++r) {
        for (std::size_t c = 0; c < r; ++c) x[r] -= corner_[r][c] * x[c];
        x[r] *= corner_[r][r];
    }
    for (std::size_t r = kBorder; r-- > 0;) {
        for (std::size_t c = r + 1; c < kBorder; ++c) x[r] -= corner_[c][r] * x[c];
        x[r] *= corner_[r][r];
    }
}

void BandCholesky::solve(std::span<double> x) const
{
    const std::size_t rows = lower_.rows();
    std::copy_n(x.begin(), rows, work_.begin());
    std::fill(work_.begin() + static_cast<std::ptrdiff_t>(rows), work_.end(), 0.0);
    solveBandForward(lower_.columns(), rows, work_);
    std::fill(work_.begin() + static_cast<std::ptrdiff_t>(rows), work_.end(), 0.0);
    if (!border_.empty()) {
        Border last;
        std::copy_n(x.begin() + static_cast<std::ptrdiff_t>(rows), kBorder, last.begin());
        for (std::size_t j = 0; j < rows; ++j)
            for (std::size_t r = 0; r < kBorder; ++r) last[r] -= border_[j][r] * work_[j];
        solveBorder(last);
        for (std::size_t j = 0; j < rows; ++j)
            for (std::size_t r = 0; r < kBorder; ++r) work_[j] -= border_[j][r] * last[r];
        std::ranges::copy(last, x.begin() + static_cast<std::ptrdiff_t>(rows));
    }
    solveBandBack(lower_.columns(), rows, work_);
    std::copy_n(work_.begin(), rows, x.begin());
}

void BandCholesky::invert(BandMatrix& inverse) const
{
    inverse.resize(rows_, !border_.empty());
    invertBand(lower_.columns(), lower_.rows(), inverse.columns());
    if (!border_.empty()) addBorder(inverse);
}

/// With A = (A_1, B^T; B, A_2), S = A_2 - B A_1^-1 B^T and W = A_1^-1 B^T: the inverse is (A_1^-1 + W S^-1 W^T,
/// -W S^-1; ., S^-1).
void BandCholesky::addBorder(BandMatrix& inverse) const
{
    const std::size_t inner = lower_.rows();
    Square s{}; // S^-1
    for (std::size_t c = 0; c < kBorder; ++c) {
        s[c][c] = 1.0;
        solveBorder(s[c]);
    }
    std::vector<Border> w(border_); // W = L^-T times the border's rows of L, transposed
    for (std::size_t j = inner; j-- > 0;) {
        const double* column = lower_.column(j);
        for (std::size_t k = 1; k <= kWidth && j + k < inner; ++k)
            for (std::size_t r = 0; r < kBorder; ++r) w[j][r] -= column[k] * w[j + k][r];
        for (double& each : w[j]) each *= column[0];
    }
    for (std::size_t j = 0; j < inner; ++j) {
        Border ws{}; // row j of W S^-1
        for (std::size_t r = 0; r < kBorder; ++r)
            for (std::size_t c = 0; c < kBorder; ++c) ws[r] += w[j][c] * s[c][r];
        double* out = inverse.column(j);
        for (std::size_t k = 0; k <= kWidth; ++k)
            for (std::size_t r = 0; r < kBorder && j + k < inner; ++r) out[k] += ws[r] * w[j + k][r];
        for (std::size_t r = 0; r < kBorder; ++r) {
            if (inner + r - j <= kWidth) inverse.at(inner + r, j) = -ws[r];
            if (j < kBorder) inverse.corner(r, j) = -ws[r];
        }
    }
    for (std::size_t c = 0; c < kBorder; ++c)
        for (std::size_t r = c; r < kBorder; ++r) inverse.at(inner + r, inner + c) = s[c][r];
}

} // namespace filasofia::linalg
