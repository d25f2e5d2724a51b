#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace filasofia {

/// The words of a list that commas separate; none if it is empty.
inline std::vector<std::string> listed(std::string_view words)
{
    std::vector<std::string> out;
    if (words.empty()) return out;
    for (std::size_t comma = words.find(','); comma != std::string_view::npos; comma = words.find(',')) {
        out.emplace_back(words.substr(0, comma));
        words.remove_prefix(comma + 1);
    }
    out.emplace_back(words);
    return out;
}

} // namespace filasofia
