/// write_cad_parts FOLDER: the parts of the tests and of scenes/data as CAD files.
#include <iostream>

#include "tests/support/cad_parts.hpp"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: write_cad_parts FOLDER\n";
    return 1;
  }
  cgcontact::test::write_cad_parts(argv[1]);
  return 0;
}
