#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace filasofia::linalg {

/// Where one list lies among the values of all lists.
struct ListRange {
    int begin = 0;
    int end = 0;
};

/// Many short lists in one array, which is the layout that inner loops read. A list that outgrows its place moves to
/// the end and leaves a hole: lists change only when a mesh is edited, a few at a time.
template <class Value> struct Lists {
    std::vector<ListRange> ranges;
    std::vector<Value> values;

    Lists() = default;
    explicit Lists(const std::vector<std::vector<Value>>& lists)
    {
        for (const std::vector<Value>& list : lists) {
            const int begin = static_cast<int>(values.size());
            values.insert(values.end(), list.begin(), list.end());
            ranges.push_back({begin, static_cast<int>(values.size())});
        }
    }

    /// Changes the number of lists; new ones are empty.
    void resize(std::size_t count) { ranges.resize(count); }

    [[nodiscard]] bool contains(std::size_t list, const Value& value) const
    {
        return std::find(begin(list), end(list), value) != end(list);
    }
    [[nodiscard]] std::size_t size(std::size_t list) const
    {
        return static_cast<std::size_t>(ranges[list].end - ranges[list].begin);
    }
    [[nodiscard]] const Value* begin(std::size_t list) const { return values.data() + ranges[list].begin; }
    [[nodiscard]] const Value* end(std::size_t list) const { return values.data() + ranges[list].end; }

    /// Appends a value to a list.
    void add(std::size_t list, const Value& value)
    {
        recordLimits();
        ListRange& range = ranges[list];
        if (range.end == limits_[list]) moveToEnd(list);
        values[static_cast<std::size_t>(range.end++)] = value;
    }

    /// Removes a value, which must be in the list; the others keep their order.
    void remove(std::size_t list, const Value& value)
    {
        recordLimits();
        const auto first = values.begin() + ranges[list].begin, last = values.begin() + ranges[list].end;
        const auto found = std::find(first, last, value);
        std::move(found + 1, last, found);
        --ranges[list].end;
    }

private:
    /// Records where the lists' places end, if no change of a list has needed it before.
    void recordLimits()
    {
        for (std::size_t i = limits_.size(); i < ranges.size(); ++i) limits_.push_back(ranges[i].end);
    }

    void moveToEnd(std::size_t list)
    {
        constexpr int kSpare = 8; // a node that an edit has reached is soon reached again
        const ListRange old = ranges[list];
        const auto begin = static_cast<int>(values.size());
        values.resize(values.size() + static_cast<std::size_t>(old.end) - static_cast<std::size_t>(old.begin) + kSpare);
        std::copy(values.begin() + old.begin, values.begin() + old.end, values.begin() + begin);
        ranges[list] = {begin, begin + old.end - old.begin};
        limits_[list] = static_cast<int>(values.size());
    }

    std::vector<int> limits_; ///< per list: where its place among the values ends
};

} // namespace filasofia::linalg
