#include "filasofia/core/suggestion.h"

#include "filasofia/core/text.h"

#include <algorithm>
#include <array>
#include <cctype>

namespace filasofia {
namespace {

/// SOFA's words for what has another name here or is one level deeper, without case and underscores.
constexpr std::array<std::array<std::string_view, 2>, 9> kOtherWords = {{{"totalmass", "mass"},
                                                                         {"massdensity", "mass"},
                                                                         {"density", "mass"},
                                                                         {"youngmodulus", "material"},
                                                                         {"poissonratio", "material"},
                                                                         {"rayleighmass", "rayleigh"},
                                                                         {"rayleighstiffness", "rayleigh"},
                                                                         {"translation", "pose"},
                                                                         {"rotation", "pose"}}};

std::string_view otherWordFor(std::string_view word)
{
    std::string plain;
    for (const char letter : word)
        if (letter != '_') plain += static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
    const auto* found = std::ranges::find(kOtherWords, plain, [](const auto& each) { return each[0]; });
    return found == kOtherWords.end() ? std::string_view() : (*found)[1];
}

} // namespace

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
    if (const std::string_view other = otherWordFor(word); std::ranges::find(known, other) != known.end())
        return text(" (did you mean '", other, "'?)");
    const std::string* nearest = nullptr;
    int smallest = std::max(1, static_cast<int>(word.size()) / 3) + 1; // a larger distance is another word, not a slip
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

std::string didYouMeanOneOf(std::string_view word, const std::vector<std::string>& known)
{
    constexpr std::size_t kFew = 12;
    std::string hint = didYouMean(word, known);
    if (!hint.empty() || known.empty() || known.size() > kFew) return hint;
    for (const std::string& each : known) hint += text(hint.empty() ? " (it has " : ", ", each);
    return hint + ")";
}

} // namespace filasofia
