#compdef arena
# Completion of `arena` in zsh: eval "$(arena completion zsh)"
_arena() {
    local -a open closed
    local candidate
    for candidate in "${(@f)$("${words[1]}" completion candidates "${(@)words[2,CURRENT-1]}" "$PREFIX" 2>/dev/null)}"; do
        case $candidate in
            '') ;;
            *[=./]) open+=("$candidate") ;;
            *) closed+=("$candidate") ;;
        esac
    done
    if (( $#open + $#closed )); then
        compadd -S '' -a open
        compadd -a closed
    else
        _files
    fi
}
(( $+functions[compdef] )) || { autoload -Uz compinit && compinit -u }
compdef _arena arena
