#include "everything.hpp"

int main() { return sizes{} == sizes_in_second() ? 0 : 1; }
