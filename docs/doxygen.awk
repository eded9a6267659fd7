# Shows Doxygen the comment that a header begins with as the file's documentation, and the angles of "mesh<B>" in
# comments as what they are, not as bold type. Lines stay where they are.

/^#pragma once/ { print "/// \\file"; is_first = 1; next }
is_first && /^\/\// { sub(/^\/\//, "///") }
!/^\/\// { is_first = 0 }
{ print with_angles($0) }

function with_angles(line,   at, parts, count, i, text) {
    at = index(line, "//")
    if (!at || line ~ /\/\/\/?     /) { # no comment, or code in one
        return line
    }
    text = substr(line, at)
    count = split(text, parts, "`")
    text = ""
    for (i = 1; i <= count; ++i) {
        if (i % 2) { # not between backticks
            gsub(/<B>/, "\\&lt;B\\&gt;", parts[i])
        }
        text = text (i > 1 ? "`" : "") parts[i]
    }
    return substr(line, 1, at - 1) text
}
