"""What is read off a solved model: numbers, pictures, files for other programs.

Start from `result.Result`; `answers.OUTPUTS` says what each number means.
"""
