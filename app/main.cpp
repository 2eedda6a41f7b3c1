#include "app/cli/cli.h"

int main(int argc, char** argv) {
  return dapple::runCommandLine(argc, argv);
}
