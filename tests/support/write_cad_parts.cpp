/// write_cad_parts FOLDER: the parts of the tests and of scenes/data as STEP files.
#include <iostream>

#include "tests/support/cad_parts.hpp"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: write_cad_parts FOLDER\n";
    return 1;
  }
  for (const auto& part : cgcontact::test::write_cad_parts(argv[1])) std::cout << part.name << "\n";
  return 0;
}
