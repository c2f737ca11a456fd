message(WARNING "This build is for processors like the one here, and so is its package. For all: cmake --workflow --preset package")
