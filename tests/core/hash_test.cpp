#include "filasofia/core/hash.h"

#include <set>

namespace hash_test {

using namespace filasofia;

namespace {

std::uint64_t hashOf(const std::vector<double>& list)
{
    Hasher hash;
    hash.addAll(std::span<const double>(list));
    return hash.value();
}

} // namespace

TEST_CASE("the hash of a list changes with every bit of it, its length and its order")
{
    for (const std::size_t length : {0, 1, 7, 8, 9, 40}) {
        std::vector<double> list(length, 0.0);
        std::set<std::uint64_t> all{hashOf(list)};
        std::size_t made = 1;
        for (std::size_t i = 0; i < length; ++i)
            for (int bit = 0; bit < 64; ++bit, ++made) {
                std::vector<double> other = list;
                other[i] = std::bit_cast<double>(std::uint64_t{1} << bit);
                all.insert(hashOf(other));
            }
        list.push_back(0.0);
        all.insert(hashOf(list));
        CHECK(all.size() == made + 1);
    }
    CHECK(hashOf({1, 2, 3, 4, 5, 6, 7, 8, 9}) != hashOf({9, 2, 3, 4, 5, 6, 7, 8, 1}));
    CHECK(hashOf({0.0}) != hashOf({-0.0}));
    CHECK(hashOf({1, 2, 3}) == hashOf({1, 2, 3}));
}

TEST_CASE("lists that differ in two places hardly ever have the same hash")
{
    std::mt19937_64 random(5);
    std::set<std::uint64_t> all;
    std::vector<double> list(64, 1.0);
    constexpr std::size_t kRounds = 100000;
    for (std::size_t round = 0; round < kRounds; ++round) {
        std::vector<double> other = list;
        for (int change = 0; change < 2; ++change)
            other[random() % other.size()] += 1e-15 * static_cast<double>(random() % 1000000);
        all.insert(hashOf(other));
    }
    CHECK(all.size() > kRounds - 5000); // few lists are equal
}

} // namespace hash_test
