#include "apps/filasofia/suggestion.h"

#include "filasofia/core/text.h"

#include <algorithm>

namespace filasofia::app {

// Optimal string alignment: Levenshtein with swaps of neighbours, row by row.
int editDistance(std::string_view a, std::string_view b)
{
    std::vector<int> before, above(b.size() + 1), row(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j) above[j] = static_cast<int>(j);
    for (std::size_t i = 1; i <= a.size(); ++i) {
        row[0] = static_cast<int>(i);
        for (std::size_t j = 1; j <= b.size(); ++j) {
            row[j] = std::min({above[j] + 1, row[j - 1] + 1, above[j - 1] + (a[i - 1] != b[j - 1])});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                row[j] = std::min(row[j], before[j - 2] + 1);
        }
        before = above;
        std::swap(above, row);
    }
    return above.back();
}

std::string didYouMean(std::string_view word, const std::vector<std::string>& known)
{
    const std::string* nearest = nullptr;
    int smallest = std::max(2, static_cast<int>(word.size()) / 3) + 1; // a larger distance is another word, not a slip
    for (const std::string& candidate : known) {
        const int distance = editDistance(word, candidate);
        // If a word shares no letter with the candidate, it is not a slip of it either.
        if (distance < smallest && distance < static_cast<int>(std::max(word.size(), candidate.size()))) {
            smallest = distance;
            nearest = &candidate;
        }
    }
    return nearest ? text(" (did you mean '", *nearest, "'?)") : std::string();
}

} // namespace filasofia::app
