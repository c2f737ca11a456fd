import support    # finds the analysis
