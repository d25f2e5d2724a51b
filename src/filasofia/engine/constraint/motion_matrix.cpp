#include "filasofia/engine/constraint/motion_matrix.h"

#include <utility>

namespace filasofia::engine {
namespace {

// Rows of blocks up to which the matrix is factorised as a dense one.
constexpr std::size_t kMostDense = 128;

} // namespace

bool MotionMatrix::isDense() const { return size_ <= kMostDense; }

void MotionMatrix::begin(std::size_t size)
{
    size_ = size;
    blocks_.assign(size, Mat3{});
    places_.clear();
    for (int i = 0; std::cmp_less(i, size); ++i) places_.push_back({i, i});
}

void MotionMatrix::add(std::size_t row, std::size_t column, const Mat3& block)
{
    if (row == column) {
        blocks_[row] += block;
        return;
    }
    places_.push_back({static_cast<int>(row), static_cast<int>(column)});
    blocks_.push_back(block);
}

void MotionMatrix::shiftDiagonal()
{
    constexpr double kShift = 1e-6;
    for (std::size_t i = 0; i < size_; ++i)
        for (int k = 0; k < 3; ++k) {
            double& entry = blocks_[i][k][k];
            entry = entry > 0.0 ? (1.0 + kShift) * entry : 1.0;
        }
}

bool MotionMatrix::factorise()
{
    if (isDense()) return factoriseDense();
    sparse_.analyse(places_, static_cast<int>(size_));
    return sparse_.factorise(blocks_);
}

bool MotionMatrix::factoriseDense()
{
    const std::size_t rows = 3 * size_;
    std::vector<double> matrix(rows * rows);
    for (std::size_t b = 0; b < blocks_.size(); ++b)
        for (int r = 0; r < 3; ++r)
            for (int c = 0; c < 3; ++c)
                matrix[static_cast<std::size_t>(3 * places_[b].row + r) * rows +
                       static_cast<std::size_t>(3 * places_[b].column + c)] += blocks_[b][r][c];
    return dense_.factorise(matrix, static_cast<int>(rows));
}

void MotionMatrix::solve(std::span<Vec3> x) const
{
    if (!isDense()) return sparse_.solve(x);
    std::vector<double> numbers;
    numbers.reserve(3 * x.size());
    for (const Vec3 each : x) numbers.insert(numbers.end(), {each.x, each.y, each.z});
    dense_.solve(numbers);
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = {numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]};
}

} // namespace filasofia::engine
