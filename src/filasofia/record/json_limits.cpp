#include "filasofia/record/json_limits.h"

namespace filasofia::record {
namespace {

void checkLimits(std::string_view line)
{
    std::array<int, kMaximumDepth + 1> members = {};
    int depth = 0;
    bool inText = false;
    for (std::size_t i = 0; i < line.size(); ++i) {
        const char c = line[i];
        if (inText) {
            if (c == '\\') ++i;
            if (c == '"') inText = false;
        } else if (c == '"') {
            inText = true;
        } else if (c == '[' || c == '{') {
            if (++depth > kMaximumDepth) fail("lists and objects must be nested at most ", kMaximumDepth, " deep");
            members[static_cast<std::size_t>(depth)] = 0;
        } else if (c == ']' || c == '}') {
            if (--depth < 0) fail("this is not a record: there is nothing that '", c, "' could close");
        } else if (c == ':' && ++members[static_cast<std::size_t>(depth)] > kMaximumMembers) {
            fail("an object must have at most ", kMaximumMembers, " members");
        }
    }
}

} // namespace

Json parsed(std::string_view line)
{
    if (line.size() > kMaximumLine) fail("a record must be <= ", kMaximumLine, " bytes, got ", line.size());
    checkLimits(line);
    try {
        return Json::parse(line.begin(), line.end());
    } catch (const Json::exception& problem) {
        fail("this is not a record: ", problem.what());
    }
}

} // namespace filasofia::record
