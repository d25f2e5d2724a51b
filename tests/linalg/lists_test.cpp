#include "filasofia/linalg/lists.h"

#include <catch2/catch.hpp>

#include <random>

namespace filasofia::linalg::lists_test {

TEST_CASE("lists that grow and shrink hold what vectors hold, in their order")
{
    std::mt19937 random(7);
    std::vector<std::vector<int>> plain(20);
    for (std::size_t i = 0; i < plain.size(); ++i)
        for (std::size_t k = 0; k < i % 5; ++k) plain[i].push_back(static_cast<int>(100 * i + k));
    Lists<int> lists(plain);
    for (int edit = 0; edit < 5000; ++edit) {
        if (edit % 500 == 499) {
            plain.emplace_back();
            lists.resize(plain.size());
        }
        const std::size_t i = random() % plain.size();
        if (random() % 2 == 0 && !plain[i].empty()) {
            const std::size_t k = random() % plain[i].size();
            lists.remove(i, plain[i][k]);
            plain[i].erase(plain[i].begin() + static_cast<std::ptrdiff_t>(k));
        } else {
            plain[i].push_back(edit + 10000);
            lists.add(i, edit + 10000);
        }
        CHECK(lists.contains(i, edit + 10000) == (!plain[i].empty() && plain[i].back() == edit + 10000));
    }
    for (std::size_t i = 0; i < plain.size(); ++i) CHECK(std::vector<int>(lists.begin(i), lists.end(i)) == plain[i]);
}

} // namespace filasofia::linalg::lists_test
