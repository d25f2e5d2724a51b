#include "filasofia/core/check_name.h"

#include "filasofia/core/error.h"

namespace check_name_test {

using namespace filasofia;
using Catch::Contains;

namespace {

std::string faultOf(std::string_view name)
{
    try {
        checkName(name, "rod");
    } catch (const Error& error) {
        return error.what();
    }
    return {};
}

} // namespace

TEST_CASE("a name in any script is one, what a line of text cannot show is none")
{
    for (const char* name : {"a", "liver 2", "foie gras, à gauche", "肝臓", "كبد", "🫀", "'", "a\xc2\xa0z"}) {
        INFO(name);
        CHECK(faultOf(name).empty());
    }
    CHECK_THAT(faultOf(""), Contains("rod: name must have a visible letter, got ''"));
    for (const char* name : {" ", "\xc2\xa0", "\xe2\x80\x8b"}) CHECK_THAT(faultOf(name), Contains("a visible letter"));
    CHECK_THAT(faultOf("a\nb"), Contains("rod: name must have no control characters, got U+000A at byte 1"));
    CHECK_THAT(faultOf(std::string_view("a\0", 2)), Contains("got U+0000 at byte 1"));
    for (const char* name : {"\x7f", "\xc2\x85", "\xe2\x80\xa8"}) CHECK_THAT(faultOf(name), Contains("control"));
    CHECK_THAT(faultOf("c\xe2\x80\xae"
                       "d"),
               Contains("rod: name must have no marks that turn the direction of text, got U+202E at byte 1"));
    for (const char* name : {"\xe2\x80\x8f", "\xe2\x81\xa6", "\xe2\x81\xa9"})
        CHECK_THAT(faultOf(name), Contains("marks"));
    // No UTF-8: a lone byte, a cut letter, a form longer than needed, half of a pair, beyond Unicode.
    for (const char* name : {"\xff", "\x80", "a\xe2\x80", "\xc0\x80", "\xed\xa0\x80", "\xf4\x90\x80\x80"})
        CHECK_THAT(faultOf(name), Contains("rod: name must be UTF-8, which it is not from byte "));
}

} // namespace check_name_test
