#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace filasofia::linalg {

/// Where one list lies among the values of all.
struct ListRange {
    int begin = 0;
    int end = 0;
};

/// Many short lists in one array, as the inner loops read them. A list that outgrows its place moves to the end and
/// leaves a hole: lists change at edits of a mesh only, a few at a time.
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

    /// Lists in all from now on; new ones are empty.
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

    /// Behind the list's others.
    void add(std::size_t list, const Value& value)
    {
        reserveRooms();
        ListRange& range = ranges[list];
        if (range.end == rooms_[list]) move(list);
        values[static_cast<std::size_t>(range.end++)] = value;
    }

    /// The others keep their order. The value must be there.
    void remove(std::size_t list, const Value& value)
    {
        reserveRooms();
        const auto first = values.begin() + ranges[list].begin, last = values.begin() + ranges[list].end;
        const auto found = std::find(first, last, value);
        std::move(found + 1, last, found);
        --ranges[list].end;
    }

private:
    /// Nobody needs to know how far a list may grow before the first one does.
    void reserveRooms()
    {
        for (std::size_t i = rooms_.size(); i < ranges.size(); ++i) rooms_.push_back(ranges[i].end);
    }

    void move(std::size_t list)
    {
        constexpr int kRoom = 8; // a node that an edit reaches is soon reached again
        const ListRange old = ranges[list];
        const auto begin = static_cast<int>(values.size());
        values.resize(values.size() + static_cast<std::size_t>(old.end) - static_cast<std::size_t>(old.begin) + kRoom);
        std::copy(values.begin() + old.begin, values.begin() + old.end, values.begin() + begin);
        ranges[list] = {begin, begin + old.end - old.begin};
        rooms_[list] = static_cast<int>(values.size());
    }

    std::vector<int> rooms_; ///< per list: where its place ends
};

} // namespace filasofia::linalg
